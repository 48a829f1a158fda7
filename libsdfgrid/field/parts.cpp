#include "sdfgrid/field/parts.h"

#include <algorithm>

#include "sdfgrid/field/build.h"
#include "sdfgrid/field/folds.h"
#include "sdfgrid/field/interpret.h"
#include "sdfgrid/field/union_tree.h"

namespace sdfgrid {
namespace {

// Maps that a union may be moved through: linear ones and translations.
bool is_linear(const Instruction& at) {
  static const int known[] = {op_number("translate"), op_number("rotate"), op_number("scale"),
                              op_number("linear")};
  return std::find(std::begin(known), std::end(known), at.op) != std::end(known);
}

// Convex functions stay so under linear maps, offsets and maxima.
bool is_convex(const std::vector<Instruction>& code) {
  static const int offset = op_number("offset");
  static const int intersection = op_number("intersection");
  return std::all_of(code.begin(), code.end(), [&](const Instruction& at) {
    switch (at.step) {
      case Step::leaf:
        return registry()[at.op].convex_solid;
      case Step::sample:
        return false;
      case Step::combine:
        return at.op == intersection;
      case Step::range:
        return at.op == offset;
      case Step::enter:
      case Step::leave:
        return is_linear(at);
    }
    return false;
  });
}

// Whether a slope had to be divided away somewhere.
bool is_scaled(const Program& program) {
  static const int region = op_number("region");
  static const int scale = op_number("scale");
  static const int linear = op_number("linear");
  return std::any_of(program.code.begin(), program.code.end(), [&](const Instruction& at) {
    if (at.step != Step::leave) return false;
    if (at.op == linear) return true;
    const float* c = constants_of(program, at);
    if (at.op == scale) return c[0] != c[1] || c[0] != c[2];
    if (at.op != region) return false;
    return ops::load_op<ops::Region>(constants_of(program, at)).scale != 1;
  });
}

// Whether it ends one of the copies that a repetition is the union of where they are close to each
// other. By itself such a copy is no bound: the nearest cells' surfaces are in the others.
bool is_copy(const Program& program, const Instruction& at) {
  static const int repeat = op_number("repeat");
  return at.step == Step::leave && at.op == repeat &&
         ops::load_op<ops::Repeat>(constants_of(program, at)).near > 0;
}

class Splitter {
 public:
  explicit Splitter(const Program& program)
      : program_(program),
        starts_(program.starts.empty() ? subtree_starts(program.code) : program.starts) {}

  std::vector<FieldPart> run() {
    split(static_cast<std::int32_t>(program_.code.size()) - 1, nullptr);
    return std::move(parts_);
  }

 private:
  // The subtree that ends at `last`; `box` holds its solid, in its own space, if that is known.
  void split(std::int32_t last, const Box* box) {
    const Instruction& at = program_.code[last];
    if (is_union(last)) {
      const std::int32_t ends[2] = {starts_[last - 1] - 1, last - 1};
      for (int i = 0; i < 2; ++i) {
        const Box operand = has_boxes(at) ? operand_box(program_, at, i) : Box{};
        split(ends[i], has_boxes(at) ? &operand : nullptr);
      }
    } else if (at.step == Step::leave && is_linear(at) && holds_union(last - 1)) {
      around_.push_back({starts_[last], last});
      split(last - 1, nullptr);
      around_.pop_back();
    } else {
      add(starts_[last], last, box);
    }
  }

  [[nodiscard]] bool holds_union(std::int32_t last) const {
    while (program_.code[last].step == Step::leave && is_linear(program_.code[last])) --last;
    return is_union(last);
  }

  // A union of nodes that may stand alone.
  [[nodiscard]] bool is_union(std::int32_t last) const {
    constexpr int kMostJoins = 3;  // one above the other, of the copies of a repetition
    return is_plain_union(program_.code[last]) && !holds_copies(last, kMostJoins);
  }
  [[nodiscard]] bool holds_copies(std::int32_t last, int most_joins) const {
    const Instruction& at = program_.code[last];
    if (!is_plain_union(at)) return is_copy(program_, at);
    return most_joins > 0 && holds_copies(last - 1, most_joins - 1) &&
           holds_copies(starts_[last - 1] - 1, most_joins - 1);
  }

  void add(std::int32_t first, std::int32_t last, const Box* known) {
    std::vector<Instruction> code;
    for (const Move& move : around_) code.push_back(program_.code[move.enter]);
    code.insert(code.end(), program_.code.begin() + first, program_.code.begin() + last + 1);
    for (std::size_t i = around_.size(); i-- > 0;) {
      code.push_back(program_.code[around_[i].leave]);
    }
    FieldPart part;
    // Around a convex function such a region is none, and by itself a node needs none.
    std::vector<Instruction> bare;
    std::copy_if(code.begin(), code.end(), std::back_inserter(bare),
                 [&](const Instruction& at) { return !is_enclosure(program_, at); });
    part.convex = is_convex(bare);
    if (part.convex) code = std::move(bare);
    part.field =
        Field(std::make_shared<const Program>(make_program(std::move(code), program_.pool)));
    part.box = known != nullptr ? moved(*known) : part.field.bounds();
    part.scaled = is_scaled(part.field.program());
    if (!part.box.empty()) parts_.push_back(std::move(part));
  }

  // A box of the innermost space in that of the whole field.
  [[nodiscard]] Box moved(Box box) const {
    for (std::size_t i = around_.size(); i-- > 0;) {
      const Instruction& at = program_.code[around_[i].leave];
      const ops::Data data = ops::data_of(program_, at);
      box = registry()[at.op].bounds(constants_of(program_, at), data, box, {}, 0);
    }
    return box;
  }

  struct Move {
    std::int32_t enter, leave;
  };

  const Program& program_;
  std::vector<std::int32_t> starts_;
  std::vector<Move> around_;
  std::vector<FieldPart> parts_;
};

}  // namespace

std::vector<FieldPart> parts_of(const Field& field) { return Splitter(field.program()).run(); }

}  // namespace sdfgrid
