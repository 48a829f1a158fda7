// What ops derive from their node or from more than numbers: linear maps, repetition, displacement,
// levels of grids and meshes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "sdfgrid/field/build.h"
#include "sdfgrid/field/displace.h"
#include "sdfgrid/field/folds.h"
#include "sdfgrid/field/formula.h"
#include "sdfgrid/field/interpret.h"
#include "sdfgrid/field/least_value.h"
#include "sdfgrid/field/ranges.h"
#include "sdfgrid/field/union_tree.h"

namespace sdfgrid::ops {
namespace {

// The largest singular value of a 3 x 3 matrix: the power method on its Gram matrix, from several
// starts, a little rounded up.
double largest_singular_value(const double m[9]) {
  double largest = 0;
  for (int start = 0; start < 4; ++start) {
    double v[3] = {start == 0 || start == 3 ? 1.0 : 0.1, start == 1 || start == 3 ? 1.0 : 0.2,
                   start == 2 || start == 3 ? 1.0 : 0.3};
    double norm = 0;
    for (int step = 0; step < 500; ++step) {
      double u[3] = {};
      double w[3] = {};
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) u[i] += m[3 * i + j] * v[j];
      }
      for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) w[j] += m[3 * i + j] * u[i];
      }
      norm = std::sqrt(std::hypot(w[0], w[1], w[2]));
      const double l = std::hypot(w[0], w[1], w[2]);
      if (!(l > 0)) break;
      for (int i = 0; i < 3; ++i) v[i] = w[i] / l;
    }
    largest = std::max(largest, norm);
  }
  return largest * (1 + 1e-6);
}

Error refused(const OpInfo& op, const std::string& what) {
  return {ErrorKind::input, fmt::format("{}: {}", op.name, what)};
}

}  // namespace

void Linear::prepare(Data) {
  double rows[9];
  std::copy(m, m + 9, rows);
  const auto minor = [&](int i, int j) {
    const int a = (i + 1) % 3;
    const int b = (i + 2) % 3;
    const int c = (j + 1) % 3;
    const int d = (j + 2) % 3;
    return rows[3 * a + c] * rows[3 * b + d] - rows[3 * a + d] * rows[3 * b + c];
  };
  const double determinant = rows[0] * minor(0, 0) + rows[1] * minor(0, 1) + rows[2] * minor(0, 2);
  double back[9];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) back[3 * j + i] = minor(i, j) / determinant;
  }
  const double stretched = largest_singular_value(back);
  if (!std::isfinite(stretched) || stretched > 1e6) {
    throw refused(info, "the matrix is singular; give one that can be inverted");
  }
  std::transform(back, back + 9, inverse, [](double v) { return static_cast<float>(v); });
  scale = static_cast<float>(1 / stretched);
}

// The derivatives of the B-spline are means of differences between neighbours, so the largest of
// those bounds them, patch by patch.
void TextureDisplacement::prepare(Data samples) {
  if (samples.count == 0) throw refused(info, "give it a picture by `file`, or `samples`");
  const int columns = static_cast<int>(width);
  if (samples.count % columns != 0) {
    throw refused(info,
                  fmt::format("{} `samples` make no rows of `width` {}", samples.count, columns));
  }
  const int rows = samples.count / columns;
  const auto [lo, hi] = std::minmax_element(samples.values, samples.values + samples.count);
  height = static_cast<float>(rows);
  least = *lo;
  most = *hi;
  const auto at = [&](int i, int j) {
    return static_cast<double>(
        samples.values[(j + 2 * rows) % rows * columns + (i + 2 * columns) % columns]);
  };
  // Per length; around the axis a turn is that of radius `around`.
  const double right = columns / (around > 0 ? 2 * std::numbers::pi * around : size[0]);
  const double down = rows / static_cast<double>(size[1]);
  double steepest = 0;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      double x = 0;
      double y = 0;
      for (int a = -1; a <= 1; ++a) {
        for (int b = -1; b <= 0; ++b) {
          x = std::max(x, std::fabs(at(i + b + 1, j + a) - at(i + b, j + a)));
          y = std::max(y, std::fabs(at(i + a, j + b + 1) - at(i + a, j + b)));
        }
      }
      steepest = std::max(steepest, std::hypot(x * right, y * down));
    }
  }
  const double fading = around > 0 ? std::max(std::fabs(least), std::fabs(most)) / around : 0;
  steepness = static_cast<float>(std::fabs(amplitude) * std::hypot(steepest, fading) * 1.00001);
  scale = 1 / (1 + steepness);
}

std::vector<float> FormulaDisplacement::list_of(const std::vector<Argument>& given) {
  const CheckedArguments arguments({&info, parameters}, given);
  return parse_formula(arguments.text("f", nullptr), arguments.number("t"));
}

namespace {

// The value that a field has at a distance from its surface, where that is a grid or a mesh and
// nothing else, moved, turned and scaled as it may be: its sampler knows. Of other fields the
// distance.
double value_at(const Field& field, double distance) {
  const Program& program = field.program();
  const Sampler* sampler = nullptr;
  double scale = 1;
  for (const Instruction& at : program.code) {
    if (at.step == Step::sample) {
      sampler = &sampler_of(program, at);
    } else if (at.step == Step::leave && registry()[at.op].similarity != nullptr) {
      scale *= registry()[at.op].similarity(constants_of(program, at));
    } else if (at.step != Step::enter) {
      return distance;
    }
  }
  return sampler != nullptr && scale > 0 ? scale * sampler->value_at(distance / scale) : distance;
}

Field level(const Field& node, double distance) {
  static const int offset = op_number("offset");
  return make_unary(offset, {static_cast<float>(value_at(node, distance))}, node);
}

bool has_files(const std::vector<Instruction>& code) {
  return std::any_of(code.begin(), code.end(),
                     [](const Instruction& at) { return at.step == Step::sample; });
}

// Whether a node keeps its shape there, but for its place and size.
bool is_move(const Program& program, const Instruction& at) {
  if (at.step != Step::leave) return false;
  const auto similarity = registry()[at.op].similarity;
  return similarity != nullptr && similarity(constants_of(program, at)) > 0;
}

// Whether its last op is a region that a large union put around a file, or files.
bool encloses_files(const Program& program) {
  const Instruction* last = &program.code.back();
  if (last->step != Step::leave || !is_enclosure(program, *last)) return false;
  --last;
  return last->step == Step::sample || is_plain_union(*last) || is_move(program, *last);
}

// The nodes of a plain union down to its files, or without any, each moved as the union is that it
// stands in; or the field itself.
void add_nodes(const Field& field, std::vector<Field>& nodes) {
  const Program& program = field.program();
  const std::vector<Instruction>& code = program.code;
  const auto field_of = [&](std::vector<Instruction> of) {
    return Field(std::make_shared<const Program>(make_program(std::move(of), program.pool)));
  };
  const bool enclosed = encloses_files(program);
  const bool moved_as_one = enclosed || is_move(program, code.back());
  if (!has_files(code) || !(is_plain_union(code.back()) || moved_as_one)) {
    nodes.push_back(field);
  } else if (is_plain_union(code.back())) {
    const auto middle = code.begin() + subtree_starts(code)[code.size() - 2];
    add_nodes(field_of({code.begin(), middle}), nodes);
    add_nodes(field_of({middle, code.end() - 1}), nodes);
  } else {
    std::vector<Field> inside;
    add_nodes(field_of({code.begin() + 1, code.end() - 1}), inside);
    for (const Field& node : inside) {
      std::vector<Instruction> moved = node.program().code;
      if (!enclosed) {
        moved.insert(moved.begin(), code.front());
        moved.push_back(code.back());
      }
      nodes.push_back(field_of(std::move(moved)));
    }
  }
}

}  // namespace

// Outwards a union grows by what its nodes grow by, so that files in it are exact, too.
Field Offset::make_around(const std::vector<Argument>& arguments, const Field& node) {
  const double by = CheckedArguments({&info, parameters}, arguments).number("by");
  if (by <= 0 || node.program().pool->samplers.empty()) return level(node, by);
  std::vector<Field> nodes;
  add_nodes(node, nodes);
  for (Field& one : nodes) one = level(one, by);
  return make_field("union", {}, nodes);
}

Field Shell::make_around(const std::vector<Argument>& arguments, const Field& node) {
  const double thick = CheckedArguments({&info, parameters}, arguments).number("thickness");
  const double half = 0.5 * thick;
  const bool level_is_distance = value_at(node, half) == half && value_at(node, -half) == -half;
  if (level_is_distance) {
    static const int shell = op_number("shell");
    return make_unary(shell, {static_cast<float>(thick)}, node);
  }
  return make_field("difference", {}, {level(node, half), level(node, -half)});
}

namespace {

// A value that a node has at least on the walls of its cell across an axis, by the boxes that it
// says to be below levels in.
double least_by_bounds(const Field& node, const Box& cell, int axis) {
  constexpr int kHalvings = 12;
  double below = 0;
  double above = cell.size()[axis];
  for (int i = 0; i < kHalvings; ++i) {
    const double level = 0.5 * (below + above);
    const Box box = node.bounds(level);
    const bool within = box.lo[axis] > cell.lo[axis] && box.hi[axis] < cell.hi[axis];
    (within ? below : above) = level;
  }
  return below > 0 ? below : -kInfinity;
}

// The least value of a node on the walls of its cell across an axis, to a hundredth.
double least_on_walls(const Field& node, const Box& cell, const std::vector<double>& edges,
                      int axis, const Box& content) {
  const double known = least_by_bounds(node, cell, axis);
  const auto close = [](const LeastValue& now) { return now.bound >= 0.99 * now.met; };
  double least = kInfinity;
  for (const double side : {cell.lo[axis], cell.hi[axis]}) {
    Box wall = cell;
    for (int b = 0; b < 3; ++b) {
      if (edges[b] > 0) continue;
      // Beyond the node a 1-Lipschitz bound may fall again, so all of the axis counts.
      wall.lo[b] = -kInfinity;
      wall.hi[b] = kInfinity;
    }
    wall.lo[axis] = wall.hi[axis] = side;
    least = std::fmin(least, least_value(node, wall, content, known, close, Job()).bound);
  }
  return least;
}

// One cell's copies of a node.
Field repeated(const Repeat& op, const Field& node) {
  std::vector<float> parameters(sizeof op / sizeof(float));
  std::memcpy(parameters.data(), &op, sizeof op);
  return make_unary(op_number("repeat"), parameters, node);
}

}  // namespace

Field Repeat::make_around(const std::vector<Argument>& given, const Field& node) {
  const CheckedArguments arguments({&info, parameters}, given);
  const std::vector<double> edges = arguments.numbers("cell");
  const Box content = node.bounds();
  if (content.empty()) return {};
  Box cell_box = content;  // of the node's own cell; along other axes where the node is
  for (int a = 0; a < 3; ++a) {
    if (edges[a] <= 0) continue;
    cell_box.lo[a] = -0.5 * edges[a];
    cell_box.hi[a] = 0.5 * edges[a];
    if (content.lo[a] > cell_box.lo[a] && content.hi[a] < cell_box.hi[a]) continue;
    const double hair = 1e-5 * edges[a];  // more than what rounding adds to a node's box
    if (content.lo[a] > cell_box.lo[a] - hair && content.hi[a] < cell_box.hi[a] + hair) {
      throw refused(info,
                    fmt::format("the node touches the walls of its cell along {}; enlarge the "
                                "cell a little, copies must not meet",
                                "xyz"[a]));
    }
    throw refused(
        info, fmt::format("the node reaches from {:g} to {:g} along {}, its cell only from "
                          "{:g} to {:g}; enlarge the cell or move the node into it",
                          content.lo[a], content.hi[a], "xyz"[a], cell_box.lo[a], cell_box.hi[a]));
  }
  Repeat op{};
  double gap = kAny;
  bool close = false;  // so much of an edge of the cell, or less
  int axes = 0;
  for (int a = 0; a < 3; ++a) {
    op.cell[a] = static_cast<float>(edges[a]);
    if (edges[a] <= 0) continue;
    constexpr double kClose = 0.2;
    const double least = least_on_walls(node, cell_box, edges, a, content);
    gap = std::fmin(gap, least);
    close = close || least < kClose * edges[a];
    ++axes;
  }
  if (!(gap > 0)) {
    throw refused(info,
                  "the node's distance is not above 0 on the walls of its cell; enlarge the cell");
  }
  // A hair less, for what single precision makes of a point on a wall.
  op.gap = static_cast<float>(gap * (1 - 1e-5));
  // Longer programs take more time than steps that end at walls.
  constexpr std::size_t kMostInstructions = 512;
  op.near = close && (node.size() + 2) << axes <= kMostInstructions ? 1 : 0;
  std::vector<Field> copies;
  for (int shifts = 0; shifts < (op.near > 0 ? 8 : 1); ++shifts) {
    bool repeats = true;
    for (int a = 0; a < 3; ++a) {
      op.shift[a] = static_cast<float>(shifts >> a & 1);
      repeats = repeats && (op.shift[a] == 0 || op.cell[a] > 0);
    }
    if (repeats) copies.push_back(repeated(op, node));
  }
  return make_field("union", {}, copies);
}

}  // namespace sdfgrid::ops
