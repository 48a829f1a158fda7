#include "sdfgrid/field/field.h"

#include <algorithm>
#include <cmath>

#include "sdfgrid/field/batch_kernel.h"
#include "sdfgrid/field/program_data.h"
#include "sdfgrid/field/slope.h"
#include "sdfgrid/field/union_tree.h"

namespace sdfgrid {
namespace {

constexpr int kLanes = 16;

// The memory that a kernel works in, one a thread.
float* scratch(std::size_t floats) {
  struct alignas(64) Line {
    float values[kLanes];
  };
  thread_local std::vector<Line> memory;
  if (memory.size() * kLanes < floats) memory = std::vector<Line>(floats / kLanes);
  return memory.front().values;
}

void sample(const Sampler* sampler, int n, const float* const p[3], float* out) {
  sampler->evaluate(n, p[0], p[1], p[2], out);
}

// Instructions from which on a copy of the points into rows of our own is worth it: those of the
// caller lie across lines of the cache and anywhere.
constexpr std::size_t kWorthCopying = 16;

}  // namespace

std::size_t Field::size() const { return program_->code.size(); }

namespace {

// The whole program at n points.
void run_program(const FieldKernel& kernel, const Program& p, std::size_t n, const float* x,
                 const float* y, const float* z, float* out) {
  std::vector<const Sampler*> samplers;
  for (const auto& s : p.pool->samplers) samplers.push_back(s.get());
  const BatchProgram program = {p.code.data(), static_cast<int>(p.code.size()),
                                p.pool->constants.data(), samplers.data(), sample};
  const auto run = kernel.run;
  float* const rows = scratch(scratch_rows(p.values, p.points) * kRow);
  float* const own[3] = {point_row(rows, 0, 0), point_row(rows, 0, 1), point_row(rows, 0, 2)};
  float* const own_out = value_row(rows, 0);
  const float* const from[3] = {x, y, z};
  const bool in_place = p.code.size() < kWorthCopying;
  std::size_t done = 0;
  while (done + kLanes <= n) {
    const std::size_t take = std::min<std::size_t>(kBatch, (n - done) / kLanes * kLanes);
    if (in_place) {
      const float* const at[3] = {x + done, y + done, z + done};
      run(program, static_cast<int>(take), at, out + done, rows);
    } else {
      for (int a = 0; a < 3; ++a) std::copy_n(from[a] + done, take, own[a]);
      const std::size_t next = std::min(n - done - take, take);
      for (std::size_t i = 0; i < next; i += kLanes) {
        for (const float* c : from) __builtin_prefetch(c + done + take + i);
        __builtin_prefetch(out + done + take + i, 1);
      }
      run(program, static_cast<int>(take), own, own_out, rows);
      std::copy_n(own_out, take, out + done);
    }
    done += take;
  }
  if (done == n) return;
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < kLanes; ++i) own[a][i] = from[a][std::min(done + i, n - 1)];
  }
  run(program, kLanes, own, own_out, rows);
  std::copy_n(own_out, n - done, out + done);
}

// A field of many nodes at many points: points that are near each other together, each group with
// what pruning leaves of the program around it.
class GroupedEvaluation {
 public:
  GroupedEvaluation(const FieldKernel& kernel, const float* x, const float* y, const float* z,
                    float* out)
      : kernel_(kernel), p_{x, y, z}, out_(out) {}

  // Asks for what is left where there are at most `ask` points.
  void run(const Field& field, std::span<std::uint32_t> points, std::size_t ask = kAnyLength) {
    Box box;
    for (const std::uint32_t i : points) box.add({p_[0][i], p_[1][i], p_[2][i]});
    const std::size_t n = points.size();
    std::optional<Restricted> here;
    if (n <= ask) {
      here = field.restricted(box, n == 1 ? kAnyLength : kMostInstructions);
      if (!here) ask = std::max<std::size_t>(1, n / 8);  // too large a place is so by far, mostly
    }
    const Field& left = here ? here->field : field;
    if (here && (n == 1 || left.size() <= (n <= kLanes ? kMostInstructions : kShort))) {
      return evaluate(left, points);
    }
    const std::size_t half = halve(points, box);
    run(left, points.first(half), ask);
    run(left, points.subspan(half), ask);
  }

  // The same of smooth unions, of which more nodes matter: of points that lie in a small part of
  // the solid's box.
  void run_smooth(const Field& field, std::span<std::uint32_t> points) {
    if (!worth(field, points.size())) return evaluate(field, points);
    constexpr double kPart = 0.25;
    Box box;
    for (const std::uint32_t i : points) box.add({p_[0][i], p_[1][i], p_[2][i]});
    if (longest(box) < kPart * longest(last_union_box(field.program()))) {
      return evaluate(field.pruned(box), points);
    }
    if (points.size() < 8 * kManyPoints) return evaluate(field, points);
    const std::size_t half = halve(points, box);
    run_smooth(field, points.first(half));
    run_smooth(field, points.subspan(half));
  }
  static bool worth(const Field& field, std::size_t points) {
    return points >= kManyPoints && field.size() >= 64 * kShort;
  }

 private:
  static constexpr std::size_t kShort = 16;
  static constexpr std::size_t kManyPoints = 128;
  static constexpr std::size_t kMostInstructions = 128;  // to look at for some points

  static double longest(const Box& box) {
    const glm::dvec3 size = box.size();
    return std::max({size.x, size.y, size.z});
  }

  // Orders the points along the box's longest side; how many are in the first half.
  std::size_t halve(std::span<std::uint32_t> points, const Box& box) const {
    int axis = 0;
    for (int a = 1; a < 3; ++a) axis = box.size()[a] > box.size()[axis] ? a : axis;
    const std::size_t half = points.size() / 2;
    const float* c = p_[axis];
    std::nth_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(half),
                     points.end(), [&](std::uint32_t i, std::uint32_t j) { return c[i] < c[j]; });
    return half;
  }

  void evaluate(const Field& field, std::span<const std::uint32_t> points) {
    const std::size_t n = points.size();
    columns_.resize(4 * n);
    float* const c = columns_.data();
    for (std::size_t k = 0; k < n; ++k) {
      for (int a = 0; a < 3; ++a) c[a * n + k] = p_[a][points[k]];
    }
    run_program(kernel_, field.program(), n, c, c + n, c + 2 * n, c + 3 * n);
    for (std::size_t k = 0; k < n; ++k) out_[points[k]] = c[3 * n + k];
  }

  const FieldKernel& kernel_;
  const float* p_[3];
  float* out_;
  std::vector<float> columns_;
};

}  // namespace

void evaluate(const FieldKernel& kernel, const Field& field, std::size_t n, const float* x,
              const float* y, const float* z, float* out) {
  const Program& program = field.program();
  const bool few = n == 0 || (!program.strewn && !GroupedEvaluation::worth(field, n));
  if (program.starts.empty() || few) return run_program(kernel, program, n, x, y, z, out);
  std::vector<std::uint32_t> points;
  points.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const bool finite = std::isfinite(x[i]) && std::isfinite(y[i]) && std::isfinite(z[i]);
    if (finite) points.push_back(static_cast<std::uint32_t>(i));
    if (!finite) run_program(kernel, program, 1, x + i, y + i, z + i, out + i);
  }
  if (points.empty()) return;
  GroupedEvaluation groups(kernel, x, y, z, out);
  if (program.strewn) {
    groups.run(field, points);
  } else {
    groups.run_smooth(field, points);
  }
}

void Field::evaluate(std::size_t n, const float* x, const float* y, const float* z,
                     float* out) const {
  sdfgrid::evaluate(field_kernel(), *this, n, x, y, z, out);
}

float Field::operator()(const glm::vec3& p) const {
  float out = 0;
  evaluate(1, &p.x, &p.y, &p.z, &out);
  return out;
}

double Field::slope(const Box& box) const {
  if (!program_->starts.empty()) {
    return std::min(1.0, slope_over(pruned(box).program(), box));
  }
  return std::min(1.0, slope_over(*program_, box));
}

Field Field::tagged(int tag) const {
  auto program = std::make_shared<Program>(*program_);
  for (Instruction& at : program->code) {
    if (at.tag < 0) at.tag = tag;
  }
  return Field(std::move(program));
}

}  // namespace sdfgrid
