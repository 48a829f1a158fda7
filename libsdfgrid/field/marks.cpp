#include "sdfgrid/field/marks.h"

#include "sdfgrid/field/program_data.h"

namespace sdfgrid {

std::optional<int> only_mark(const Field& field) {
  std::optional<int> mark;
  for (const Instruction& at : field.program().code) {
    if (at.step == Step::sample) return std::nullopt;
    if (at.step != Step::leaf) continue;
    if (mark && *mark != at.tag) return std::nullopt;
    mark = at.tag;
  }
  return mark.value_or(-1);
}

}  // namespace sdfgrid
