#include "sdfgrid/field/union_tree.h"

#include <algorithm>
#include <numeric>

#include "sdfgrid/field/build.h"
#include "sdfgrid/field/interpret.h"

namespace sdfgrid {
namespace {

using ops::kFloatSlack;
using ops::kInfinity;

// What a leaf's value may be off, in proportion to its coordinates: as in leaf_interval().
constexpr double kRounding = 4 * kFloatSlack;

// Whether a program computes the Euclidean distance wherever that is positive.
bool exact_outside(const Program& program) {
  static const int translate = op_number("translate");
  static const int rotate = op_number("rotate");
  static const int scale = op_number("scale");
  const auto exact = [&](const Instruction& at) {
    if (at.step == Step::leaf) {
      return registry()[at.op].entry.info->guarantee <= OpGuarantee::exact_outside;
    }
    if (at.step == Step::combine) return at.op == kUnionOp;
    if (at.step != Step::enter && at.step != Step::leave) return false;
    const float* by = constants_of(program, at);
    if (at.op == scale) return by[0] == by[1] && by[0] == by[2];
    return at.op == translate || at.op == rotate;
  };
  return std::all_of(program.code.begin(), program.code.end(), exact);
}

// One of the nodes on its way into the tree.
struct Part {
  Field field;
  Box box;
  std::uint32_t constants = 0;  // where its pool begins in that of all
  std::uint32_t samplers = 0;
};

// The node so that its value outside of its box is at least the distance to that.
Part enclosed(const Field& node) {
  Box box = node.bounds();
  if (box.empty() || exact_outside(node.program())) return {node, box};
  if (!box.finite()) return {node, {glm::dvec3(-kInfinity), glm::dvec3(kInfinity)}};
  const glm::dvec3 size = box.size();
  const double far = std::max({std::fabs(box.lo.x), std::fabs(box.lo.y), std::fabs(box.lo.z),
                               std::fabs(box.hi.x), std::fabs(box.hi.y), std::fabs(box.hi.z)});
  const glm::dvec3 margin(1e-4 * std::max({size.x, size.y, size.z}) + 1e-6 * far + 1e-30);
  box = {box.lo - margin, box.hi + margin};
  return {within_region(node, box, 1), box};
}

Part as_it_is(const Field& node) {
  const Box box = node.bounds();
  if (!box.empty() && exact_outside(node.program())) return {node, box};
  return {node, {glm::dvec3(-kInfinity), glm::dvec3(kInfinity)}};
}

class TreeBuilder {
 public:
  TreeBuilder(Draft& draft, std::vector<Part> parts, const Instruction& join)
      : draft_(draft), parts_(std::move(parts)), join_(join) {
    const float* constants = draft.pool.constants.data() + join.constants;
    lower_ = registry()[join.op].child_level(constants, 0);
  }

  void build() {
    // In their order: of nodes that share a surface the first one's is seen.
    for (Part& part : parts_) {
      Pool& pool = draft_.pool;
      const Pool& from = *part.field.program().pool;
      part.constants = static_cast<std::uint32_t>(pool.constants.size());
      part.samplers = static_cast<std::uint32_t>(pool.samplers.size());
      pool.constants.insert(pool.constants.end(), from.constants.begin(), from.constants.end());
      pool.samplers.insert(pool.samplers.end(), from.samplers.begin(), from.samplers.end());
    }
    std::vector<int> order(parts_.size());
    std::iota(order.begin(), order.end(), 0);
    if (join_.op != kUnionOp) {
      append(order);
      return;
    }
    const auto endless = std::stable_partition(order.begin(), order.end(),
                                               [&](int i) { return parts_[i].box.finite(); });
    const std::span<int> ends(order.begin(), endless);
    const std::span<int> rest(endless, order.end());
    if (ends.empty() || rest.empty()) {
      append(order);
    } else {
      const Box a = append(rest);
      const Box b = append(ends);
      join(a, b);
    }
  }

 private:
  Box append(std::span<int> of) {
    if (of.size() == 1) return append_part(parts_[of[0]]);
    const std::size_t half = (of.size() + 1) / 2;
    halve(of, half);
    const Box a = append(of.first(half));
    const Box b = append(of.subspan(half));
    return join(a, b);
  }

  // Along the axis along which their middles are spread farthest.
  void halve(std::span<int> of, std::size_t half) {
    if (join_.op != kUnionOp) return;  // in their order
    Box middles;
    for (const int i : of) middles.add(parts_[i].box.center());
    const glm::dvec3 size = middles.size();
    if (!std::isfinite(size.x + size.y + size.z)) return;  // have no middle
    int axis = size.x >= size.y ? 0 : 1;
    if (size.z > size[axis]) axis = 2;
    std::nth_element(of.begin(), of.begin() + static_cast<std::ptrdiff_t>(half), of.end(),
                     [&](int i, int j) {
                       const double a = parts_[i].box.center()[axis];
                       const double b = parts_[j].box.center()[axis];
                       return a < b || (a == b && i < j);
                     });
  }

  Box append_part(const Part& part) {
    for (Instruction at : part.field.program().code) {
      at.constants += part.constants;
      at.data += part.constants;
      at.sampler += part.samplers;
      draft_.code.push_back(at);
    }
    return part.box;
  }

  // The boxes a little larger, for the rounding of their own coordinates.
  Box join(const Box& a, const Box& b) {
    std::vector<float>& constants = draft_.pool.constants;
    Instruction at = join_;
    at.data = static_cast<std::uint32_t>(constants.size());
    at.count = kUnionFloats;
    for (const Box* box : {&a, &b}) {
      double far = 0;
      for (int i = 0; i < 3; ++i) {
        if (std::isfinite(box->lo[i])) far += std::fabs(box->lo[i]);
        if (std::isfinite(box->hi[i])) far += std::fabs(box->hi[i]);
      }
      for (int i = 0; i < 3; ++i) {
        constants.push_back(static_cast<float>(box->lo[i] - kRounding * far));
      }
      for (int i = 0; i < 3; ++i) {
        constants.push_back(static_cast<float>(box->hi[i] + kRounding * far));
      }
    }
    draft_.code.push_back(at);
    const Box both = ops::both_boxes(a, b);
    return {both.lo - lower_, both.hi + lower_};
  }

  Draft& draft_;
  std::vector<Part> parts_;
  Instruction join_;
  double lower_;  // by how much a join may be less than both its operands
};

}  // namespace

bool is_enclosure(const Program& program, const Instruction& at) {
  static const int region = op_number("region");
  return (at.step == Step::enter || at.step == Step::leave) && at.op == region &&
         ops::load_op<ops::Region>(constants_of(program, at)).scale == 1;
}

Box operand_box(const Program& program, const Instruction& at, int operand) {
  const bool second = (operand == 1) != (at.count == kUnionSwapped);
  const float* f = program.pool->constants.data() + at.data + (second ? 6 : 0);
  return {glm::dvec3(f[0], f[1], f[2]), glm::dvec3(f[3], f[4], f[5])};
}

Box last_union_box(const Program& program) {
  const auto found = std::find_if(program.code.rbegin(), program.code.rend(), has_boxes);
  if (found == program.code.rend()) return {glm::dvec3(-kInfinity), glm::dvec3(kInfinity)};
  return ops::both_boxes(operand_box(program, *found, 0), operand_box(program, *found, 1));
}

void append_union_tree(Draft& draft, std::span<const Field> of, const Instruction& join) {
  std::vector<Part> parts;
  parts.reserve(of.size());
  for (const Field& node : of) {
    Part part = join.op == kUnionOp ? enclosed(node) : as_it_is(node);
    if (!part.box.empty()) parts.push_back(std::move(part));
  }
  if (parts.empty()) parts.push_back({Field(), {}});
  TreeBuilder(draft, std::move(parts), join).build();
}

void least_of_operands(const Program& program, const Instruction& at,
                       const ops::Point<ops::Interval>& p, double far, double least[2]) {
  const float* f = program.pool->constants.data() + at.data;
  const ops::Interval* const c[3] = {&p.x, &p.y, &p.z};
  const int first = at.count == kUnionSwapped ? 1 : 0;
  for (int operand = 0; operand < 2; ++operand, f += 6) {
    double square = 0;
    for (int a = 0; a < 3; ++a) {
      const double gap =
          ops::greater(0, ops::greater(f[a] - c[a]->hi, c[a]->lo - static_cast<double>(f[a + 3])));
      square += gap * gap;
    }
    const double gap = std::sqrt(square);
    const double safe = gap - kRounding * (far + gap);
    least[operand ^ first] = safe > 0 ? safe : -kInfinity;
  }
}

}  // namespace sdfgrid
