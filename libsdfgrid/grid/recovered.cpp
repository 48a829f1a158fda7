#include "sdfgrid/grid/recovered.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <utility>
#include <vector>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/vdb.h"

namespace sdfgrid {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
using Accessor = openvdb::FloatGrid::ConstAccessor;

constexpr std::size_t kLeavesPerTask = 32;

// For the steps to the 26 neighbours.
template <class Work>
void for_neighbours(const Work& work) {
  for (int n = 0; n < 27; ++n) {
    if (n != 13) work(openvdb::Coord(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1));
  }
}

double length(const openvdb::Coord& step) {
  constexpr double kLengths[] = {0, 1, 1.4142135623730951, 1.7320508075688772};
  return kLengths[std::abs(step.x()) + std::abs(step.y()) + std::abs(step.z())];
}

// A leaf's values, with those one voxel around it.
class Apron {
 public:
  Apron(const Leaf& leaf, const Accessor& values) : first_(leaf.origin().offsetBy(-1)) {
    float* out = values_;
    for (int x = 0; x < kEdge; ++x) {
      for (int y = 0; y < kEdge; ++y) {
        for (int z = 0; z < kEdge; ++z) *out++ = values.getValue(first_.offsetBy(x, y, z));
      }
    }
  }
  float operator[](const openvdb::Coord& at) const {
    const openvdb::Coord p = at - first_;
    return values_[(p.x() * kEdge + p.y()) * kEdge + p.z()];
  }
  // Whether there is a value of some kind.
  template <class Kind>
  [[nodiscard]] bool holds(const Kind& kind) const {
    return std::any_of(std::begin(values_), std::end(values_), kind);
  }

 private:
  static constexpr int kEdge = 10;
  openvdb::Coord first_;
  float values_[kEdge * kEdge * kEdge];
};

// Where the surface of a field is met on the ways from a leaf's voxels to their neighbours.
class NearZeros {
 public:
  NearZeros(const Field& field, const Lattice& lattice) : field_(field), lattice_(lattice) {}

  // Sets those voxels that have a neighbour on the other side, as `values` has it, to their
  // distance from the plane that touches the surface at the nearest of its zeros.
  void place(Leaf& leaf, const Apron& values) {
    ways_.clear();
    for (auto it = leaf.beginValueOn(); it; ++it) {
      if (!add(it.getCoord(), values, true)) add(it.getCoord(), values, false);
    }
    find_zeros();
    for (std::size_t i = 0; i < ways_.size();) {
      const openvdb::Coord at = ways_[i].at;
      const Way* nearest = &ways_[i];
      for (; i < ways_.size() && ways_[i].at == at; ++i) {
        if (ways_[i].lo * length(ways_[i].step) < nearest->lo * length(nearest->step)) {
          nearest = &ways_[i];
        }
      }
      leaf.setValueOnly(at, std::copysign(distance(*nearest), values[at]));
    }
  }

 private:
  static constexpr double kLeast = 1e-3;  // of a way: a zero at the voxel itself keeps its sign
  struct Way {
    openvdb::Coord at, step;
    double lo = 0, hi = 1;  // the parts of the step between which the zero lies
  };

  // The ways to the other side along the axes, or the others. Whether there are any.
  bool add(const openvdb::Coord& at, const Apron& values, bool axes) {
    const std::size_t before = ways_.size();
    const bool inside = values[at] < 0;
    for_neighbours([&](const openvdb::Coord& step) {
      if ((length(step) == 1) != axes) return;
      if ((values[at + step] < 0) != inside) ways_.push_back({at, step});
    });
    return ways_.size() > before;
  }

  [[nodiscard]] glm::dvec3 place_of(const Way& way, double part) const {
    const glm::dvec3 step(way.step.x(), way.step.y(), way.step.z());
    return lattice_.to_world(glm::dvec3(way.at.x(), way.at.y(), way.at.z()) + part * step);
  }

  [[nodiscard]] float distance(const Way& way) const {
    const glm::dvec3 normal = field_.gradient(place_of(way, way.lo)).gradient;
    const glm::dvec3 step = place_of(way, way.lo) - place_of(way, 0);
    const double along = std::abs(glm::dot(normal, step)) / glm::length(normal);
    const double least = kLeast * glm::length(step);
    return static_cast<float>(along > least ? along : least);  // least also without a normal
  }

  // By halving until the field is not cut off any more at either end, then linearly.
  void find_zeros() {
    constexpr int kHalvings = 5;
    const std::size_t n = ways_.size();
    for (auto* column : {&p_[0], &p_[1], &p_[2], &lo_, &hi_, &middle_}) column->resize(n);
    evaluate(lo_, [](const Way& way) { return way.lo; });
    evaluate(hi_, [](const Way& way) { return way.hi; });
    for (int k = 0; k < kHalvings; ++k) {
      const auto half = [](const Way& way) { return (way.lo + way.hi) / 2; };
      evaluate(middle_, half);
      for (std::size_t i = 0; i < n; ++i) {
        const bool farther = (middle_[i] < 0) == (lo_[i] < 0);
        (farther ? ways_[i].lo : ways_[i].hi) = half(ways_[i]);
        (farther ? lo_[i] : hi_[i]) = middle_[i];
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double part = lo_[i] / (static_cast<double>(lo_[i]) - hi_[i]);
      Way& way = ways_[i];
      if (part > 0 && part < 1) way.lo += part * (way.hi - way.lo);
      way.lo = std::max(way.lo, kLeast);
    }
  }

  // The field at a place on each way.
  template <class Part>
  void evaluate(std::vector<float>& out, const Part& part) {
    for (std::size_t i = 0; i < ways_.size(); ++i) {
      const glm::dvec3 p = place_of(ways_[i], part(ways_[i]));
      for (int a = 0; a < 3; ++a) p_[a][i] = static_cast<float>(p[a]);
    }
    field_.evaluate(ways_.size(), p_[0].data(), p_[1].data(), p_[2].data(), out.data());
  }

  const Field& field_;
  const Lattice& lattice_;
  std::vector<Way> ways_;  // of one voxel side by side
  std::vector<float> p_[3], lo_, hi_, middle_;
};

// A voxel is no farther from the surface than any neighbour on its side and the way there.
void approach(Leaf& leaf, const Apron& values, double voxel) {
  for (auto it = leaf.beginValueOn(); it; ++it) {
    const float own = *it;
    float nearest = std::abs(own);
    for_neighbours([&](const openvdb::Coord& step) {
      const float other = values[it.getCoord() + step];
      const auto way = static_cast<float>(voxel * length(step));
      if ((other < 0) == (own < 0)) nearest = std::min(nearest, std::abs(other) + way);
    });
    it.setValue(std::copysign(nearest, own));
  }
}

// Changes a copy of the grid leaf by leaf.
template <class Change>
Grid changed(const Grid& grid, const Job& job, const Change& change) {
  const openvdb::FloatGrid::ConstPtr from = vdb(grid);
  const Grid result = grid.clone();
  std::vector<Leaf*> leaves;
  vdb(result)->tree().getNodes(leaves);
  parallel_for(leaves.size(), kLeavesPerTask, job, [&](std::size_t begin, std::size_t end) {
    const Accessor values = from->getConstAccessor();
    for (std::size_t i = begin; i < end; ++i) change(*leaves[i], Apron(*leaves[i], values));
  });
  return result;
}

}  // namespace

Grid recovered(const Grid& grid, const Field& field, const Job& job) {
  const Lattice lattice = grid.lattice();
  const auto most = static_cast<float>(grid.background());
  Grid result = changed(grid, job, [&](Leaf& leaf, const Apron& values) {
    for (auto it = leaf.beginValueOn(); it; ++it) it.setValue(std::copysign(most, *it));
    const bool inside = values[leaf.origin()] < 0;
    const auto is_other = [&](float d) { return (d < 0) != inside; };
    if (values.holds(is_other)) NearZeros(field, lattice).place(leaf, values);
  });
  const int layers = static_cast<int>(std::ceil(most / lattice.voxel));
  for (int layer = 1; layer < layers; ++layer) {
    result = changed(result, job, [&](Leaf& leaf, const Apron& values) {
      const auto is_known = [&](float d) { return std::abs(d) < most; };
      if (values.holds(is_known)) approach(leaf, values, lattice.voxel);
    });
  }
  return result;
}

}  // namespace sdfgrid
