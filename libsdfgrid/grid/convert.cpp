#include "sdfgrid/grid/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/memory.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/level_set.h"
#include "sdfgrid/grid/vdb.h"
#include "sdfgrid/transform/mesh_transform.h"
#include "sdfgrid/voxelize/empty_space.h"
#include "sdfgrid/voxelize/mesh_voxelizer.h"

namespace sdfgrid {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
constexpr double kPi = 3.14159265358979323846;
constexpr double kMostVoxels = 1e8;  // a side

class Stopwatch {
 public:
  // Seconds since the last call, or since the start.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

// The leaves of one node, by place, so that threads may fill them in any order.
using NodeLeaves = std::vector<LeafPointer>;

// All leaves of a mesh, by node.
struct MeshLeaves {
  std::vector<NodeLeaves> nodes;
  bool contradicted = false;  // see MeshVoxelizer
};

NodeLeaves run_node(MeshVoxelizer& voxelizer, std::size_t node, const Job& job) {
  NodeLeaves leaves(kNodeBricks * kNodeBricks * kNodeBricks);
  const glm::ivec3 origin = voxelizer.node_origin(node);
  voxelizer.run(
      node,
      [&](const Brick& brick) {
        const glm::ivec3 at = (brick.origin - origin) / kBrickEdge;
        leaves[(at.x * kNodeBricks + at.y) * kNodeBricks + at.z] =
            make_leaf(brick.origin, brick.values, brick.active);
      },
      job);
  std::erase(leaves, nullptr);
  leaves.shrink_to_fit();  // a large grid has thousands of nodes
  return leaves;
}

MeshLeaves make_exact_leaves(const SignedMesh& mesh, const Lattice& lattice, const Band& band,
                             const Job& job) {
  MeshVoxelizer voxelizer(mesh, lattice, band, job);
  MeshLeaves leaves;
  leaves.nodes.resize(voxelizer.nodes());
  parallel_for("voxelize", voxelizer.nodes(), 1, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      leaves.nodes[node] = run_node(voxelizer, node, job);
    }
  });
  leaves.contradicted = voxelizer.contradicted();
  return leaves;
}

MeshLeaves make_leaves(const SignedMesh& mesh, const Lattice& lattice,
                       const ConvertOptions& options, const Job& job) {
  if (!options.transform) return make_exact_leaves(mesh, lattice, options.band, job);
  const auto transform = make_mesh_transform(mesh, lattice, options.band, *options.transform, job);
  MeshLeaves leaves;
  NodeLeaves& all = leaves.nodes.emplace_back(transform->bricks());
  transform->run(
      [&](std::size_t i, const Brick& brick) {
        all[i] = make_leaf(brick.origin, brick.values, brick.active);
      },
      job);
  std::erase(all, nullptr);
  leaves.contradicted = transform->contradicted();
  return leaves;
}

// Whether the sign changes in the brick or between it and a sample beside it.
bool borders_sign_change(const openvdb::FloatTree& tree, const Leaf& leaf) {
  const openvdb::tree::ValueAccessor<const openvdb::FloatTree> accessor(tree);
  const bool negative = leaf.getFirstValue() < 0;
  const openvdb::Coord lo = leaf.origin().offsetBy(-1);
  for (int x = 0; x < kBrickEdge + 2; ++x) {
    for (int y = 0; y < kBrickEdge + 2; ++y) {
      for (int z = 0; z < kBrickEdge + 2; ++z) {
        if ((accessor.getValue(lo.offsetBy(x, y, z)) < 0) != negative) return true;
      }
    }
  }
  return false;
}

// Meshes with holes: the winding number says where inside is.
void fill_interior(openvdb::FloatGrid& grid, float in_background, const SignedMesh& mesh,
                   const Lattice& lattice, const Job& job) {
  std::vector<glm::ivec3> bricks;
  bricks.reserve(grid.tree().leafCount());
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    bricks.emplace_back(leaf->origin().x(), leaf->origin().y(), leaf->origin().z());
  }
  const EmptySpace empty =
      sign_empty_space(*mesh.winding, lattice, lattice.origin - mesh.soup.origin, bricks, job);
  for (const InsideBox& box : empty.inside) {
    grid.tree().fill(openvdb::CoordBBox::createCube(to_coord(box.lo), box.edge), -in_background,
                     false);
  }
  std::vector<Leaf*> caps;
  for (const CapBrick& cap : empty.caps) {
    Leaf* leaf = grid.tree().touchLeaf(to_coord(cap.origin));
    for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
      const bool inside = (cap.negative[i >> 6] >> (i & 63) & 1) != 0;
      leaf->setValueOff(i, inside ? -in_background : grid.background());
    }
    caps.push_back(leaf);
  }
  std::erase_if(caps, [&](const Leaf* leaf) { return borders_sign_change(grid.tree(), *leaf); });
  for (const Leaf* leaf : caps) {
    const openvdb::Coord origin = leaf->origin();  // addTile deletes the leaf
    const float value = leaf->getFirstValue();
    grid.tree().addTile(1, origin, value, false);
  }
}

// Values, seeds and queues beside the leaves that are made of them: what tests/convert/memory_test
// measures at its peak, and an eighth more.
double transform_bytes_per_sample(TransformMethod method) {
  switch (method) {
    case TransformMethod::meijster:
      return 28;
    case TransformMethod::feature:
      return 20;
    case TransformMethod::closest_point:
      return 17;
    default:
      return 14;
  }
}

double surface_area(const TriangleSoup& soup) {
  double area = 0;
  for (const glm::uvec3& t : soup.triangles) {
    const glm::dvec3 a = soup.local(t.x);
    area += 0.5 * glm::length(glm::cross(soup.local(t.y) - a, soup.local(t.z) - a));
  }
  return area;
}

}  // namespace

double convert_error(const Band& band) {
  constexpr double kNear = 1e-5;
  constexpr double kRelative = 4e-7;  // 6.5 roundings to float
  return std::max(kNear, kRelative * std::max(band.exwidth, band.inwidth));
}

Lattice choose_lattice(const TriangleSoup& soup, const ConvertOptions& options) {
  const glm::dvec3 size = bounds(soup).size();
  const double longest = std::max({size.x, size.y, size.z});
  Lattice lattice;
  lattice.voxel = options.voxel;
  if (lattice.voxel == 0) {
    if (options.dim < 1) throw Error(ErrorKind::usage, "--dim must be at least 1");
    lattice.voxel = longest / options.dim;
  }
  if (!(std::isfinite(lattice.voxel) && lattice.voxel > 1e-30)) {
    throw Error(ErrorKind::usage,
                "the voxel size must be a positive number; a mesh without extent "
                "needs --voxel");
  }
  if (!(longest / lattice.voxel < kMostVoxels)) {
    throw Error(ErrorKind::usage, "the voxel size is too small for the mesh; use a larger one");
  }
  lattice.origin = lattice.voxel * glm::round(soup.origin / lattice.voxel);
  return lattice;
}

double estimate_memory(const TriangleSoup& soup, const Lattice& lattice,
                       const ConvertOptions& options) {
  const Band& band = options.band;
  constexpr double kBrickMargin = 6;  // voxels by which bricks overhang the band, on average
  const double out = band.exwidth + kBrickMargin;
  const double in = band.inwidth + kBrickMargin;
  const double area = surface_area(soup) / (lattice.voxel * lattice.voxel);
  const Box box = bounds(soup);
  const glm::dvec3 size = box.empty() ? glm::dvec3(0) : box.size() / lattice.voxel;
  // Outside, what Steiner's formula gives for a convex body of that area in that box; inside no
  // more than a prism on the surface; in all no more than the box and the band around it.
  const double sides = size.x + size.y + size.z;
  const double shell =
      area * (in + out) + kPi * out * out * sides + 4.0 / 3.0 * kPi * out * out * out;
  const glm::dvec3 full = size + 2 * band.exwidth + 16.0;
  const double bricks =
      soup.triangles.empty() ? 0 : std::min(shell, full.x * full.y * full.z) / Leaf::SIZE;
  constexpr double kBytesPerBrick = sizeof(Leaf) + sizeof(float) * Leaf::SIZE + 64;
  constexpr double kBytesPerTriangle = 450;  // topology, and bins of the nodes at work
  const double transform_bytes =
      options.transform ? Leaf::SIZE * transform_bytes_per_sample(options.transform->method) : 0.0;
  return bricks * (kBytesPerBrick + transform_bytes) +
         kBytesPerTriangle * static_cast<double>(soup.triangles.size()) + 50e6;
}

Conversion convert_mesh(const TriangleSoup& soup, const ConvertOptions& options, const Job& job) {
  if (soup.triangles.empty()) throw Error(ErrorKind::input, "the mesh has no triangles");
  if (!(options.band.exwidth >= 1 && options.band.inwidth >= 1)) {
    throw Error(ErrorKind::usage, "a band must be at least 1 voxel wide");
  }
  const Lattice lattice = choose_lattice(soup, options);
  check_allowed(estimate_memory(soup, lattice, options), options.max_memory, "the conversion",
                "use a larger voxel, a narrower band");
  Stopwatch watch;
  Conversion result;
  SignedMesh mesh = prepare_sign(soup, options.sign, job);
  result.seconds.sign = watch.lap();
  MeshLeaves leaves = make_leaves(mesh, lattice, options, job);
  result.seconds.voxelize = watch.lap();
  if (leaves.contradicted && options.sign == SignMethod::automatic) {
    leaves = {};
    sign_by_winding(mesh, "the mesh is closed but crosses itself", job);
    result.seconds.sign += watch.lap();
    leaves = make_leaves(mesh, lattice, options, job);
    result.seconds.voxelize += watch.lap();
  } else if (leaves.contradicted) {
    mesh.warnings.emplace_back(
        "the mesh crosses itself: signs by normals are wrong near there; --sign winding makes one "
        "solid of it");
  }
  result.sign = mesh.method;
  result.sign_reason = mesh.reason;
  result.warnings = mesh.warnings;

  const auto vdb = make_level_set(lattice, options.band);
  if (mesh.method == SignMethod::no_sign) vdb->setGridClass(openvdb::GRID_UNKNOWN);
  openvdb::tree::ValueAccessor<openvdb::FloatTree> accessor(vdb->tree());
  for (NodeLeaves& node : leaves.nodes) {
    for (LeafPointer& leaf : node) accessor.addLeaf(leaf.release());
    node = NodeLeaves();
  }
  const auto in_background = static_cast<float>(options.band.inwidth * lattice.voxel);
  if (mesh.method == SignMethod::normal) {
    flood_interior(*vdb, in_background);
  } else if (mesh.method == SignMethod::winding) {
    fill_interior(*vdb, in_background, mesh, lattice, job);
  }
  result.grid = from_vdb(vdb);
  result.seconds.assemble = watch.lap();
  return result;
}

}  // namespace sdfgrid
