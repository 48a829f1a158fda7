#include "sdfgrid/field/emptiness.h"

#include <algorithm>
#include <queue>
#include <string_view>

#include "sdfgrid/field/program_data.h"
#include "sdfgrid/field/registry.h"

namespace sdfgrid {
namespace {

// A part of the box, with what is left of the field there.
struct Region {
  Box box;
  Restricted here;
  bool operator<(const Region& other) const { return here.range.lo > other.here.range.lo; }
};

Box half_of(const Box& box, int axis, bool upper) {
  Box half = box;
  (upper ? half.lo : half.hi)[axis] = box.center()[axis];
  return half;
}

int longest_axis(const Box& box) {
  const glm::dvec3 size = box.size();
  const int xy = size.y > size.x ? 1 : 0;
  return size.z > size[xy] ? 2 : xy;
}

}  // namespace

bool is_surely_empty(const Field& field, const Box& box, std::size_t most) {
  if (box.empty()) return true;
  std::priority_queue<Region> regions;  // the least value uppermost
  const auto add = [&](const Field& around, const Box& part) {
    Region region{part, *around.restricted(part)};
    if (region.here.range.lo <= 0) regions.push(std::move(region));
  };
  add(field, box);
  for (std::size_t looked = 0; !regions.empty(); ++looked) {
    const Region region = regions.top();
    regions.pop();
    if (looked >= most || region.here.field(glm::vec3(region.box.center())) <= 0) return false;
    const int axis = longest_axis(region.box);
    for (const bool upper : {false, true}) {
      add(region.here.field, half_of(region.box, axis, upper));
    }
  }
  return true;
}

std::vector<std::string> ops_that_take_away(const Field& field) {
  std::vector<std::string> found;
  for (const Instruction& at : field.program().code) {
    const OpInfo* op = registry()[at.op].entry.info;
    if (op == nullptr) continue;  // a file
    const std::string_view name = op->name;
    const bool takes = name.ends_with("intersection") || name.ends_with("difference") ||
                       name == "complement" || name == "offset" || name == "shell" ||
                       name.ends_with("_displace");
    if (takes && std::find(found.begin(), found.end(), name) == found.end()) {
      found.emplace_back(name);
    }
  }
  return found;
}

}  // namespace sdfgrid
