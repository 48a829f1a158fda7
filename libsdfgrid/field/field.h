// field/field.h: an analytic distance field: a flat program of ops (spheres, unions, twists, ...),
// made by name from the list of ops, and its readings.
//
// A field is negative inside and never larger than the distance to the surface, anywhere: its
// gradient is at most 1 by construction. Lengths are in world units, coordinates single precision.
// Fields are values: cheap to copy, immutable, safe to read from many threads.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/field/op.h"

namespace sdfgrid {

struct Program;

// One op of the list: what it says of itself, and its parameters.
struct OpEntry {
  const OpInfo* info;
  std::span<const Parameter> parameters;
};

// All ops that scene files may name, most used first within each family.
[[nodiscard]] std::span<const OpEntry> op_list();
// Null if there is no such op.
[[nodiscard]] const OpEntry* find_op(std::string_view name);

// A named parameter's value: numbers (one, three, nine, or a list), or a text.
struct Argument {
  std::string name;
  std::variant<std::vector<double>, std::string> value;

  Argument(std::string n, double v) : name(std::move(n)), value(std::vector<double>{v}) {}
  Argument(std::string n, std::initializer_list<double> v)
      : name(std::move(n)), value(std::vector<double>(v)) {}
  Argument(std::string n, std::vector<double> v) : name(std::move(n)), value(std::move(v)) {}
  Argument(std::string n, std::string v) : name(std::move(n)), value(std::move(v)) {}
  Argument(std::string n, const char* v) : name(std::move(n)), value(std::string(v)) {}
};

// All values of a field over a box lie in [lo, hi].
struct ValueRange {
  double lo, hi;
};

// Program lengths without limit.
inline constexpr std::size_t kAnyLength = static_cast<std::size_t>(-1);

struct Restricted;

struct ValueGradient {
  double value;
  glm::dvec3 gradient;  // of length at most 1; one of several at a kink
};

// A distance that the field does not compute itself: a sampled grid, a mesh. Must not be larger
// than the distance to its surface, negative inside, and 1-Lipschitz; the same bits for the same
// point whatever stands beside it.
class Sampler {
 public:
  Sampler() = default;
  Sampler(const Sampler&) = delete;
  Sampler& operator=(const Sampler&) = delete;
  virtual ~Sampler() = default;
  // Values at n points; may be called from many threads.
  virtual void evaluate(int n, const float* x, const float* y, const float* z,
                        float* out) const = 0;
  // A box outside of which the value is at least the distance to it.
  [[nodiscard]] virtual Box hull() const = 0;
  // Holds every point where the value is below `level`.
  [[nodiscard]] virtual Box bounds(double level) const;
  // The same in double precision, for gradients by differences over steps of length step().
  [[nodiscard]] virtual double value(const glm::dvec3& p) const = 0;
  [[nodiscard]] virtual double step() const = 0;
  // The value at that signed distance from the surface, where it is less by some rule.
  [[nodiscard]] virtual double value_at(double distance) const { return distance; }
  // Values up to these, inside and outside and both positive, say where the surface is; larger
  // ones only that it is further away. Infinite where all do.
  [[nodiscard]] virtual double reach_inside() const {
    return std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] virtual double reach_outside() const {
    return std::numeric_limits<double>::infinity();
  }
  // The mark of its surface near a point, or -1 for that of the leaf: see Field::tagged().
  [[nodiscard]] virtual int tag(const glm::dvec3& /*p*/) const { return -1; }
};

// The values of a sampler that a field looks at, by offsets, shells and blends: from lo <= 0 inside
// to hi >= 0 outside.
struct SamplerUse {
  const Sampler* sampler;
  double lo, hi;
};

// Widens what is looked at of a sampler, which may be new among `uses`, and returns it.
SamplerUse& add_use(std::vector<SamplerUse>& uses, const SamplerUse& use);

class Field {
 public:
  // Empty space: 1e9 everywhere, farther than anything.
  Field();

  // Values at n points. The bits depend on the point alone, not on what stands beside it, and are
  // the same on every x86 machine (samplers have to be so for themselves).
  void evaluate(std::size_t n, const float* x, const float* y, const float* z, float* out) const;
  [[nodiscard]] float operator()(const glm::vec3& p) const;

  // In double precision, with the gradient by differentiating every op.
  [[nodiscard]] ValueGradient gradient(const glm::dvec3& p) const;

  // Bounds on what evaluate() gives anywhere in the box, by interval arithmetic and by the
  // gradient's bound; the box may be infinite.
  [[nodiscard]] ValueRange range(const Box& box) const;

  // A box that holds every point where the value is below `level`; axes without end are infinite,
  // the box is empty if there is no such point.
  [[nodiscard]] Box bounds(double level = 0) const;
  // Each sampler once, with all values that are looked at.
  [[nodiscard]] std::vector<SamplerUse> sampler_uses() const;

  // A bound on the gradient over the box, at most 1 and often less: inside it a step may be longer
  // by its inverse. See local_bounds.h.
  [[nodiscard]] double slope(const Box& box) const;

  // The field over one box, shorter where parts cannot matter there: the same bits at any point of
  // the box, anything elsewhere.
  [[nodiscard]] Field pruned(const Box& box) const;
  // pruned() and range() at once; nothing if a union by place has more than `most` to look at.
  // Where the value is at least `upper`, that of what is left may be another such.
  [[nodiscard]] std::optional<Restricted> restricted(
      const Box& box, std::size_t most = kAnyLength,
      double upper = std::numeric_limits<double>::infinity()) const;

  // A function `float NAME(vec3 p)` in GLSL (1.30 and later, or ES 3.00) with the same values up to
  // rounding. Throws Error{input} where a Sampler takes part.
  [[nodiscard]] std::string glsl(const std::string& function = "field") const;

  // Marks all surfaces that carry no mark yet, by a number >= 0 (a material, say).
  [[nodiscard]] Field tagged(int tag) const;
  // The mark of the surface that decides the value at p, or -1.
  [[nodiscard]] int tag_at(const glm::dvec3& p) const;

  // Ops in the program, those that move or bound space included.
  [[nodiscard]] std::size_t size() const;

  explicit Field(std::shared_ptr<const Program> program) : program_(std::move(program)) {}
  [[nodiscard]] const Program& program() const { return *program_; }

 private:
  std::shared_ptr<const Program> program_;
};

// What is left of a field over a box, and its values there.
struct Restricted {
  Field field;
  ValueRange range;
};

// The field of an op: leaves have no `of`, range and domain ops one (several: their union),
// combinations one or more. Throws Error{input} that names op, parameter and remedy for an unknown
// op or parameter, a value out of range, a missing one, and for nodes nested deeper than
// kMaxNesting.
[[nodiscard]] Field make_field(std::string_view op, const std::vector<Argument>& arguments = {},
                               const std::vector<Field>& of = {});
inline constexpr int kMaxNesting = 400;

// A leaf whose distance something else computes.
[[nodiscard]] Field make_field(std::shared_ptr<const Sampler> sampler);

}  // namespace sdfgrid
