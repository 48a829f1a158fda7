// field/program.h: the flat postfix program of a field: plain data, shared with the kernels
// (internal to field/).
//
// Two stacks: of values and of points. A leaf reads the uppermost point and pushes a value; a
// combination pops two values and pushes one; a range op replaces the uppermost value; a domain op
// pushes a point when it is entered and pops it, perhaps changing the value, when it is left.
#pragma once

#include <cstdint>

namespace sdfgrid {

class Sampler;

// `sample` is a leaf that a Sampler computes.
enum class Step : std::uint8_t { leaf, sample, combine, range, enter, leave };

struct Instruction {
  std::uint16_t op;  // family * kFamilySize + place in the family (op_list.h)
  Step step;
  float offset[3];          // Step::leaf: where its origin is, a translation of its own
  std::uint32_t constants;  // index of the op's struct in the program's constants
  std::uint32_t data;       // index of its list in the same, and
  std::uint32_t count;      // how many floats the list has
  std::uint32_t sampler;    // index in the program's samplers, for Step::sample
  std::int32_t tag;         // whose surface this is (Field::tagged), or -1
};

inline constexpr int kFamilySize = 64;
inline constexpr int kBatch = 512;      // points a block of the batch reading
inline constexpr int kMaxValues = 128;  // depth of the stack of values
inline constexpr int kMaxPoints = 64;   // of the stack of points

// The stacks of the batch reading lie in rows of 4096 bytes, coordinates in the first halves,
// values in the second: a load that agrees with a store before it in the lower twelve bits of its
// address has to wait for that store, so leaves would wait for the values of the op before them.
inline constexpr int kRow = 2 * kBatch;
inline float* point_row(float* rows, int depth, int axis) {
  return rows + static_cast<long>(depth * 3 + axis) * kRow;
}
inline float* value_row(float* rows, int depth) {
  return rows + static_cast<long>(depth) * kRow + kBatch;
}
// For the depths of a program's stacks, the outermost point among them.
inline unsigned long scratch_rows(int values, int points) {
  const int coordinates = 3 * (points + 1);
  return static_cast<unsigned long>(values > coordinates ? values : coordinates);
}

// One op over one block of points; all arrays hold `n` floats, a multiple of the lanes.
struct BatchStep {
  int n;
  const float* constants;
  const float* data;
  int count;
  const float* offset;  // Instruction::offset
  const float* p[3];    // the point; for Step::leave the one outside
  float* q[3];          // Step::enter: the point inside
  const float* a;       // values
  const float* b;
  float* out;
};
using BatchFunction = void (*)(const BatchStep& step);

// The functions of one family of ops; leave[i] is null where leaving changes nothing.
struct BatchFamily {
  const BatchFunction* apply;
  const BatchFunction* leave;
};

}  // namespace sdfgrid
