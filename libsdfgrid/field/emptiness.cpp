#include "sdfgrid/field/emptiness.h"

#include <algorithm>

#include "sdfgrid/field/interval.h"
#include "sdfgrid/field/least_value.h"
#include "sdfgrid/field/program_data.h"
#include "sdfgrid/field/registry.h"

namespace sdfgrid {

bool is_surely_empty(const Field& field, const Job& job) {
  const Box box = field.bounds();
  if (box.empty()) return true;
  const auto decided = [](const LeastValue& now) { return now.bound > 0 || now.met <= 0; };
  return least_value(field, box, box, -ops::kInfinity, decided, job).bound > 0;
}

std::vector<std::string> ops_that_take_away(const Field& field) {
  std::vector<std::string> found;
  for (const Instruction& at : field.program().code) {
    const RegisteredOp& op = registry()[at.op];
    if (at.step == Step::sample || !op.takes_away) continue;
    const std::string name = op.entry.info->name;
    if (std::find(found.begin(), found.end(), name) == found.end()) found.push_back(name);
  }
  return found;
}

}  // namespace sdfgrid
