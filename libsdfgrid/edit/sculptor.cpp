#include "sdfgrid/edit/sculptor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <tuple>
#include <unordered_map>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/edit/block.h"
#include "sdfgrid/edit/brick_edit.h"
#include "sdfgrid/edit/paint_bricks.h"
#include "sdfgrid/edit/stroke_plan.h"

namespace sdfgrid {
namespace {

// Bricks whose new values are in memory at once: for several threads, and for one, which finds them
// in its cache when they are written.
constexpr std::size_t kTogether = 4096;
constexpr std::size_t kFew = 4;
constexpr std::size_t kGrain = 16;  // bricks a thread takes at a time
constexpr std::size_t kTooFewToShare = 64;
constexpr std::size_t kAhead = 3;  // bricks that are asked for while one is worked on

IndexBox default_range(const Grid& grid) {
  IndexBox box;
  grid.active_bounds(box.lo, box.hi);
  const glm::ivec3 size = box.hi - box.lo + 1;
  const int more = std::max(std::max(size.x, std::max(size.y, size.z)) / 2, 64);
  return {box.lo - more, box.hi + more};
}

void check_grid(const Grid& grid, const BandLimits& limits) {
  if (!grid.is_level_set()) {
    throw Error(ErrorKind::input,
                "the grid has no inside, so nothing can be added to it or taken away; convert with "
                "a sign (--sign auto)");
  }
  if (grid.active_voxels() == 0) {
    throw Error(ErrorKind::input, "the grid has no samples to sculpt; convert a mesh first");
  }
  const double widest = std::max(limits.outside, -limits.inside) / grid.lattice().voxel;
  if (widest > kWidestBand + 1e-3) {
    throw Error(ErrorKind::input,
                fmt::format("the grid's band is {:.3g} voxels wide, sculpting takes at most {:g}; "
                            "convert with a smaller --width",
                            widest, kWidestBand));
  }
}

// Whether no stroke of this kind can change a brick of one value.
bool cannot_change(StrokeOp op, const GridBrick& brick, const BandLimits& limits) {
  if (brick.values != nullptr) return false;
  return op == StrokeOp::unite ? brick.constant <= limits.inside : brick.constant >= limits.outside;
}

// Asks for a brick's values ahead of time: dabs are so quick that most of it is waiting for memory.
void fetch(const GridBrick& brick) {
  if (brick.values == nullptr) return;
  constexpr int kLine = 16;  // floats
  for (int i = 0; i < kBrickSamples; i += kLine) __builtin_prefetch(brick.values + i, 1);
}

bool is_empty(const std::uint64_t (&words)[8]) {
  return std::all_of(std::begin(words), std::end(words), [](std::uint64_t w) { return w == 0; });
}

bool is_constant(const RedistancedBrick& brick) {
  return is_empty(brick.active) &&
         std::all_of(std::begin(brick.values), std::end(brick.values),
                     [&](float value) { return value == brick.values[0]; });
}

void for_bricks(std::size_t count, const Job& job,
                const std::function<void(std::size_t, std::size_t)>& body) {
  if (count > kTooFewToShare) return parallel_for(count, kGrain, job, body);
  job.checkpoint();
  body(0, count);
}

}  // namespace

// One stroke on its way through the grid. What it changed so far is in `record`.
class Sculptor::Pass {
 public:
  Pass(Sculptor& sculptor, const Stroke& stroke, const Job& job)
      : sculptor_(sculptor), stroke_(stroke), job_(job), record_(sculptor.history_.new_record()) {}

  // Throws what is wrong with the stroke itself.
  void prepare() {
    const double voxel = sculptor_.grid_.lattice().voxel;
    PlanLimits limits;
    limits.range = sculptor_.options_.range;
    limits.margin =
        (std::max(sculptor_.limits_.outside, -sculptor_.limits_.inside) + 1.25 * stroke_.smooth) /
        voxel;
    limits.max_bricks = sculptor_.options_.max_bricks;
    margin_ = limits.margin;
    plan_ = plan_stroke(stroke_, sculptor_.grid_.lattice(), limits);
    if (stroke_.op == StrokeOp::flatten) find_normals();
  }

  StrokeReport run() {
    prepare();
    if (stroke_.op == StrokeOp::intersect) add_bricks_beyond();
    try {
      change();
      sculptor_.bricks_.finish();
      report_.dabs = plan_.dabs;
      report_.warnings = plan_.warnings;
      report_.bricks_touched = record_.size();
      sculptor_.touched_ = record_.changes();
      sculptor_.history_.push(std::move(record_));
    } catch (...) {
      record_.exchange(sculptor_.bricks_);
      throw;
    }
    return report_;
  }

 private:
  void change() {
    if (is_csg(stroke_.op)) return combine();
    if (stroke_.op != StrokeOp::paint) return shape();
    paint_bricks(stroke_, plan_, context(), sculptor_.bricks_, record_, job_);
  }
  void add_bricks_beyond();
  void combine();
  void find_candidates();
  void combine(std::size_t begin, std::size_t end);
  void shape();
  void shape(const ClayDab& dab, const std::vector<glm::ivec3>& bricks);
  ClayDab dab_of(std::size_t placement) const;
  void find_normals();
  void commit(const BrickEdit& edit);
  void remember(const BrickChange& change, const GridBrick& now);
  bool reaches(const PlannedBrick& planned) const;
  EditContext context() const {
    return {sculptor_.bricks_, sculptor_.grid_.lattice(), sculptor_.limits_,
            sculptor_.options_.range};
  }
  void remeasure();
  void add_all_tasks();

  Sculptor& sculptor_;
  const Stroke& stroke_;
  const Job& job_;
  StrokePlan plan_;
  double margin_ = 0;  // voxels beyond the brush that it may change
  struct Candidate {
    const PlannedBrick* planned;
    GridBrick before;
  };
  std::vector<Candidate> candidates_;
  UndoRecord record_;
  std::unordered_map<std::uint64_t, std::size_t> remembered_;  // bricks that may come twice
  std::vector<RedistanceTask> tasks_;
  std::vector<glm::vec3> normals_;  // for flattening, of each mirror image
  StrokeReport report_;
};

// An intersection removes what is beyond the brush's reach, too.
void Sculptor::Pass::add_bricks_beyond() {
  const std::vector<glm::ivec3> there =
      bricks_below(sculptor_.grid_, sculptor_.options_.range.lo >> 3,
                   sculptor_.options_.range.hi >> 3, sculptor_.limits_.outside);
  const std::vector<PlannedBrick> reached = std::move(plan_.bricks);
  plan_.bricks.clear();
  const auto before = [](const glm::ivec3& a, const glm::ivec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  std::size_t next = 0;
  for (const glm::ivec3& brick : there) {
    while (next < reached.size() && before(reached[next].brick, brick)) ++next;  // empty ones
    const bool known = next < reached.size() && reached[next].brick == brick;
    plan_.bricks.push_back(known ? reached[next] : PlannedBrick{brick, 0, 0, false});
  }
}

void Sculptor::Pass::combine() {
  find_candidates();
  record_.reserve(candidates_.size());
  const bool shared = candidates_.size() > kTooFewToShare && thread_count() > 1;
  const std::size_t together = shared ? kTogether : kFew;
  for (std::size_t begin = 0; begin < candidates_.size(); begin += together) {
    combine(begin, std::min(begin + together, candidates_.size()));
  }
  remeasure();
}

// The planned bricks that the stroke may change.
void Sculptor::Pass::find_candidates() {
  const GridBricks& bricks = sculptor_.bricks_;
  for (const PlannedBrick& planned : plan_.bricks) bricks.fetch_place(planned.brick);
  for (const PlannedBrick& planned : plan_.bricks) bricks.fetch(planned.brick);
  const bool no_suspects = sculptor_.options_.redistance == Redistance::off;
  candidates_.reserve(plan_.bricks.size());
  for (const PlannedBrick& planned : plan_.bricks) {
    const GridBrick before = bricks.find(planned.brick);
    if (cannot_change(stroke_.op, before, sculptor_.limits_)) continue;
    if ((before.values == nullptr || no_suspects) && !reaches(planned)) continue;
    candidates_.push_back({&planned, before});
  }
}

// Whether the brush may change samples of the brick itself: of a ball, not the surface in it only.
// Samples further from it may be suspects.
bool Sculptor::Pass::reaches(const PlannedBrick& planned) const {
  if (stroke_.op == StrokeOp::intersect || stroke_.brush.shape) return true;
  if (planned.end - planned.begin != 1) return true;
  const Placement& ball = plan_.placements[plan_.reaching[planned.begin]];
  if (ball.from != ball.to) return true;
  const glm::dvec3 first = 8.0 * glm::dvec3(planned.brick);
  const glm::dvec3 nearest = glm::clamp(ball.from, first, first + 7.0);
  const double reach = std::max(ball.radius_from, ball.radius_to) + margin_;
  const glm::dvec3 away = ball.from - nearest;
  return glm::dot(away, away) <= reach * reach;
}

// Combines some of the candidates and writes them into the grid.
void Sculptor::Pass::combine(std::size_t begin, std::size_t end) {
  std::vector<BrickEdit>& edits = sculptor_.edits_;
  if (edits.size() < end - begin) edits.resize(end - begin);
  const EditContext context = this->context();
  for_bricks(end - begin, job_, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      const std::size_t at = begin + i;
      if (at + kAhead < candidates_.size()) fetch(candidates_[at + kAhead].before);
      edits[i].brick = candidates_[at].planned->brick;
      edits[i].before = candidates_[at].before;
      combine_brick(stroke_, plan_, *candidates_[at].planned, context, edits[i]);
    }
  });
  for (std::size_t i = 0; i < end - begin; ++i) commit(edits[i]);
}

// The dabs of a clay tool one after the other, each on what the last one left.
void Sculptor::Pass::shape() {
  std::vector<std::vector<glm::ivec3>> bricks(plan_.placements.size());
  for (const PlannedBrick& planned : plan_.bricks) {
    for (std::uint32_t i = planned.begin; i < planned.end; ++i) {
      bricks[plan_.reaching[i]].push_back(planned.brick);
    }
  }
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    shape(dab_of(i), bricks[i]);
    remeasure();
    tasks_.clear();
  }
}

void Sculptor::Pass::shape(const ClayDab& dab, const std::vector<glm::ivec3>& bricks) {
  std::vector<BrickEdit>& edits = sculptor_.edits_;
  std::size_t count = 0;
  if (edits.size() < bricks.size()) edits.resize(bricks.size());
  for (const glm::ivec3& brick : bricks) {
    edits[count].brick = brick;
    edits[count].before = sculptor_.bricks_.find(brick);
    ++count;
  }
  const EditContext context = this->context();
  for_bricks(count, job_, [&](std::size_t from, std::size_t to) {
    const GridBricks finder(context.bricks);  // one serves one thread
    const EditContext mine{finder, context.lattice, context.limits, context.range};
    for (std::size_t i = from; i < to; ++i) shape_brick(stroke_, dab, mine, edits[i]);
  });
  for (std::size_t i = 0; i < count; ++i) commit(edits[i]);
}

// The plane to flatten to touches the surface at the first dab of the stroke, or of its mirror
// image.
ClayDab Sculptor::Pass::dab_of(std::size_t placement) const {
  const Placement& p = plan_.placements[placement];
  ClayDab dab;
  dab.middle = p.from;
  dab.radius = static_cast<float>(p.radius_from);
  dab.strength = static_cast<float>(stroke_.strength * p.pressure);
  dab.clipped = plan_.clipped;
  if (stroke_.op != StrokeOp::flatten) return dab;
  dab.normal = normals_[p.image];
  dab.from_plane = glm::vec3(p.from - plan_.starts[p.image]);
  return dab;
}

void Sculptor::Pass::find_normals() {
  const double voxel = sculptor_.grid_.lattice().voxel;
  for (const glm::dvec3& at : plan_.starts) {
    const glm::ivec3 brick = glm::ivec3(glm::floor(at / 8.0));
    Block block;
    block.fill(sculptor_.bricks_, brick, 2, voxel);
    const glm::vec3 g = block.sample(glm::vec3(at - 8.0 * glm::dvec3(brick))).gradient;
    const float length = glm::length(g);
    if (!(length > 0)) {
      throw Error(ErrorKind::usage,
                  "the path must begin at the surface, whose plane there is what is flattened to");
    }
    normals_.push_back(g / length);
  }
}

// Puts a change into the record; the brick's state only if it is not there yet.
void Sculptor::Pass::remember(const BrickChange& change, const GridBrick& now) {
  const bool once = is_csg(stroke_.op) && sculptor_.options_.redistance == Redistance::off;
  if (once) return record_.add(change, now);
  const glm::ivec3& brick = change.brick;
  constexpr int kBits = 21;
  constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;
  const std::uint64_t key = (static_cast<std::uint64_t>(brick.x) & kMask) << 2 * kBits |
                            (static_cast<std::uint64_t>(brick.y) & kMask) << kBits |
                            (static_cast<std::uint64_t>(brick.z) & kMask);
  const auto [at, is_new] = remembered_.try_emplace(key, record_.size());
  if (is_new) return record_.add(change, now);
  record_.add_samples(at->second, change.samples);
}

void Sculptor::Pass::commit(const BrickEdit& edit) {
  GridBricks& bricks = sculptor_.bricks_;
  const CombineOutput& made = edit.made;
  if (made.any_changed) {
    BrickChange change{edit.brick, {}};
    std::memcpy(change.samples, made.changed, sizeof change.samples);
    remember(change, edit.before);
    if (made.all_inside || made.all_outside) {
      bricks.drop(edit.brick,
                  made.all_inside ? sculptor_.limits_.inside : sculptor_.limits_.outside);
      return;
    }
    const GridBrick now = bricks.make_unset(edit.brick);
    std::memcpy(now.values, edit.after, sizeof edit.after);
    std::memcpy(now.active, made.active, sizeof made.active);
  }
  if (sculptor_.options_.redistance == Redistance::off) return;
  RedistanceTask task;
  task.brick = edit.brick;
  std::memcpy(task.suspect, made.suspect, sizeof task.suspect);
  if (!is_csg(stroke_.op)) {
    task.beside_surface = true;
  } else if (stroke_.smooth > 0 || (stroke_.brush.shape && !stroke_.brush.shape->exact)) {
    // What was made is no distance, beside the surface neither.
    task.beside_surface = true;
    for (int word = 0; word < 8; ++word)
      task.suspect[word] |= made.changed[word] & made.active[word];
  }
  if (!is_empty(task.suspect)) tasks_.push_back(task);
}

void Sculptor::Pass::add_all_tasks() {
  tasks_.clear();
  for (const glm::ivec3& brick : all_bricks(sculptor_.grid_)) {
    RedistanceTask task;
    task.brick = brick;
    std::memcpy(task.suspect, sculptor_.bricks_.find(brick).active, sizeof task.suspect);
    tasks_.push_back(task);
  }
}

void Sculptor::Pass::remeasure() {
  if (sculptor_.options_.redistance == Redistance::full) add_all_tasks();
  if (tasks_.empty()) return;
  const std::vector<RedistancedBrick> found = redistance(
      sculptor_.bricks_, sculptor_.grid_.lattice().voxel, sculptor_.limits_, tasks_, job_);
  for (const RedistancedBrick& brick : found) {
    const GridBrick now = sculptor_.bricks_.find(brick.change.brick);
    remember(brick.change, now);
    std::memcpy(now.values, brick.values, sizeof brick.values);
    std::memcpy(now.active, brick.active, sizeof brick.active);
    if (is_constant(brick)) sculptor_.bricks_.drop(brick.change.brick, brick.values[0]);
  }
  report_.remeasured += found.size();
}

Sculptor::Sculptor(const Grid& grid, const SculptOptions& options)
    : grid_(grid),
      options_(options),
      limits_(band_limits(grid)),
      bricks_(grid),
      history_(options.undo) {
  check_grid(grid, limits_);
  if (options_.range.lo.x > options_.range.hi.x) options_.range = default_range(grid);
}

Sculptor::~Sculptor() = default;

void Sculptor::check(const Stroke& stroke, const Job& job) { Pass(*this, stroke, job).prepare(); }

StrokeReport Sculptor::apply(const Stroke& stroke, const Job& job) {
  // Beyond the band the model's distances are cut off, which a wider blend would take for nearness.
  const double widest = std::min(limits_.outside, -limits_.inside);
  if (stroke.smooth <= widest) return Pass(*this, stroke, job).run();
  Stroke narrower = stroke;
  narrower.smooth = widest;
  StrokeReport report = Pass(*this, narrower, job).run();
  report.warnings.push_back(
      fmt::format("the blend is {:.4g} wide, the grid's band {:.4g}: it was made as wide as the "
                  "band; convert with a larger --width for more",
                  stroke.smooth, widest));
  return report;
}

bool Sculptor::undo() {
  if (history_.undoable() == 0) return false;
  touched_ = history_.undo(bricks_);
  return true;
}

bool Sculptor::take_back() {
  if (history_.undoable() == 0) return false;
  touched_ = history_.take_back(bricks_);
  return true;
}

bool Sculptor::redo() {
  if (history_.redoable() == 0) return false;
  touched_ = history_.redo(bricks_);
  return true;
}

}  // namespace sdfgrid
