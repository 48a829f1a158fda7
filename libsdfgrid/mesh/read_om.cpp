// OM, OpenMesh's own format, through OpenMesh's reader and an importer of ours: its half-edge
// meshes would drop what is not manifold.
#include <fmt/format.h>

#include <OpenMesh/Core/IO/IOManager.hh>
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <OpenMesh/Core/IO/reader/OMReader.hh>
#include <OpenMesh/Core/Mesh/ArrayKernel.hh>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "sdfgrid/core/error.h"
#include "sdfgrid/mesh/read_om_filter.h"

namespace sdfgrid::mesh_io {
namespace {

using OpenMesh::FaceHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

struct ImportError : std::runtime_error {
  ImportError(std::string where, const std::string& problem)
      : std::runtime_error(problem), place(std::move(where)) {}
  std::string place;
};

// What OpenMesh's reader fills instead of one of its meshes. Gathers points and faces as they come.
// Faces that come as half-edges become loops of corners in take(). All but topology and positions
// is passed over.
class SoupImporter final : public OpenMesh::IO::BaseImporter {
 public:
  // The mesh, once reading is done. Throws ImportError if indices are out of range or loops do not
  // close.
  [[nodiscard]] Polygons take();

  VertexHandle add_vertex(const OpenMesh::Vec3f& p) override;
  VertexHandle add_vertex(const OpenMesh::Vec3d& p) override;
  VertexHandle add_vertex() override;
  HalfedgeHandle add_edge(VertexHandle from, VertexHandle to) override;
  FaceHandle add_face(const VHandles& corners) override;
  FaceHandle add_face(HalfedgeHandle any) override;
  void set_point(VertexHandle v, const OpenMesh::Vec3f& p) override;
  void set_next(HalfedgeHandle halfedge, HalfedgeHandle next) override;

  // The reader refuses an importer without a kernel, and uses it for custom properties only.
  OpenMesh::BaseKernel* kernel() override { return &kernel_; }
  [[nodiscard]] std::size_t n_vertices() const override { return mesh_.points.size(); }
  [[nodiscard]] std::size_t n_faces() const override { return mesh_.sizes.size() + loops_.size(); }
  [[nodiscard]] std::size_t n_edges() const override { return to_.size() / 2; }

  void set_halfedge(VertexHandle, HalfedgeHandle) override {}
  void set_face(HalfedgeHandle, FaceHandle) override {}
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<OpenMesh::Vec2f>&) override {}
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<OpenMesh::Vec3f>&) override {}
  void set_face_texindex(FaceHandle, int) override {}
  void set_normal(VertexHandle, const OpenMesh::Vec3f&) override {}
  void set_normal(VertexHandle, const OpenMesh::Vec3d&) override {}
  void set_normal(FaceHandle, const OpenMesh::Vec3f&) override {}
  void set_normal(FaceHandle, const OpenMesh::Vec3d&) override {}
  void set_color(VertexHandle, const OpenMesh::Vec3uc&) override {}
  void set_color(VertexHandle, const OpenMesh::Vec4uc&) override {}
  void set_color(VertexHandle, const OpenMesh::Vec3f&) override {}
  void set_color(VertexHandle, const OpenMesh::Vec4f&) override {}
  void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec3uc&) override {}
  void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec4uc&) override {}
  void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec3f&) override {}
  void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec4f&) override {}
  void set_color(FaceHandle, const OpenMesh::Vec3uc&) override {}
  void set_color(FaceHandle, const OpenMesh::Vec4uc&) override {}
  void set_color(FaceHandle, const OpenMesh::Vec3f&) override {}
  void set_color(FaceHandle, const OpenMesh::Vec4f&) override {}
  void set_texcoord(VertexHandle, const OpenMesh::Vec2f&) override {}
  void set_texcoord(VertexHandle, const OpenMesh::Vec3f&) override {}
  void set_texcoord(HalfedgeHandle, const OpenMesh::Vec2f&) override {}
  void set_texcoord(HalfedgeHandle, const OpenMesh::Vec3f&) override {}
  void set_status(VertexHandle, const OpenMesh::Attributes::StatusInfo&) override {}
  void set_status(HalfedgeHandle, const OpenMesh::Attributes::StatusInfo&) override {}
  void set_status(OpenMesh::EdgeHandle, const OpenMesh::Attributes::StatusInfo&) override {}
  void set_status(FaceHandle, const OpenMesh::Attributes::StatusInfo&) override {}
  void request_face_texcoords2D() override {}
  void add_texture_information(int, std::string) override {}

 private:
  void unroll_loops();

  OpenMesh::ArrayKernel kernel_;
  Polygons mesh_;
  std::vector<int> to_, next_;  // a half-edge: the point that it leads to, the one that follows
  std::vector<int> loops_;      // a face: one of its half-edges
};

VertexHandle SoupImporter::add_vertex(const OpenMesh::Vec3f& p) {
  return add_vertex(OpenMesh::Vec3d(p[0], p[1], p[2]));
}

VertexHandle SoupImporter::add_vertex(const OpenMesh::Vec3d& p) {
  mesh_.points.emplace_back(p[0], p[1], p[2]);
  return VertexHandle(static_cast<int>(mesh_.points.size() - 1));
}

VertexHandle SoupImporter::add_vertex() { return add_vertex(OpenMesh::Vec3d(0.0, 0.0, 0.0)); }

HalfedgeHandle SoupImporter::add_edge(VertexHandle from, VertexHandle to) {
  const int halfedge = static_cast<int>(to_.size());
  to_.insert(to_.end(), {to.idx(), from.idx()});
  next_.insert(next_.end(), {-1, -1});
  return HalfedgeHandle(halfedge);
}

FaceHandle SoupImporter::add_face(const VHandles& corners) {
  for (const VertexHandle v : corners) {
    mesh_.corners.push_back(static_cast<std::uint32_t>(v.idx()));
  }
  mesh_.sizes.push_back(static_cast<std::uint32_t>(corners.size()));
  return FaceHandle(static_cast<int>(mesh_.sizes.size() - 1));
}

FaceHandle SoupImporter::add_face(HalfedgeHandle any) {
  loops_.push_back(any.idx());
  return FaceHandle(static_cast<int>(loops_.size() - 1));
}

void SoupImporter::set_point(VertexHandle v, const OpenMesh::Vec3f& p) {
  mesh_.points.at(v.idx()) = {p[0], p[1], p[2]};
}

void SoupImporter::set_next(HalfedgeHandle halfedge, HalfedgeHandle next) {
  next_.at(halfedge.idx()) = next.idx();
}

void SoupImporter::unroll_loops() {
  const auto halfedges = static_cast<int>(to_.size());
  std::vector<bool> used(to_.size(), false);
  for (std::size_t face = 0; face < loops_.size(); ++face) {
    std::uint32_t size = 0;
    int at = loops_[face];
    do {
      if (at < 0 || at >= halfedges || used[at]) {
        throw ImportError(
            fmt::format("face {}", face),
            at < 0 || at >= halfedges
                ? fmt::format("half-edge {} is out of range: there are {}", at, halfedges)
                : fmt::format("its loop runs into half-edge {} again", at));
      }
      used[at] = true;
      mesh_.corners.push_back(static_cast<std::uint32_t>(to_[at]));
      ++size;
      at = next_[at];
    } while (at != loops_[face]);
    mesh_.sizes.push_back(size);
  }
}

Polygons SoupImporter::take() {
  unroll_loops();
  std::size_t first = 0;
  for (std::size_t face = 0; face < mesh_.sizes.size(); first += mesh_.sizes[face++]) {
    for (std::size_t k = first; k < first + mesh_.sizes[face]; ++k) {
      if (mesh_.corners[k] >= mesh_.points.size()) {
        throw ImportError(
            fmt::format("face {}", face),
            fmt::format("index {} is out of range: there are {}",
                        static_cast<int>(mesh_.corners[k]), counted(mesh_.points.size(), "point")));
      }
    }
  }
  mesh_.format = "OM";
  return std::move(mesh_);
}

// OpenMesh reports on std::cerr; what goes wrong is thrown here instead.
class QuietOpenMesh {
 public:
  QuietOpenMesh() : errors_(omerr().is_enabled()), log_(omlog().is_enabled()) {
    omerr().disable();
    omlog().disable();
  }
  ~QuietOpenMesh() {
    if (errors_) omerr().enable();
    if (log_) omlog().enable();
  }
  QuietOpenMesh(const QuietOpenMesh&) = delete;
  QuietOpenMesh& operator=(const QuietOpenMesh&) = delete;

 private:
  bool errors_, log_;
};

}  // namespace

Polygons read_om(const Source& source) {
  std::istringstream stream(filter_om(source));
  SoupImporter importer;
  bool whole = false;
  {
    static std::mutex one_at_a_time;  // the reader is a singleton and keeps its state in itself
    const std::lock_guard lock(one_at_a_time);
    const QuietOpenMesh quiet;
    OpenMesh::IO::Options options;
    OpenMesh::IO::OMReader();  // links the reader, which registers itself with the manager
    whole = OpenMesh::IO::IOManager().read(stream, "om", importer, options);
  }
  if (!whole) throw input_error(source.path, "", "OpenMesh cannot read it", kSaveOmAgain);
  try {
    return importer.take();
  } catch (const ImportError& error) {
    throw input_error(source.path, error.place, error.what(), kSaveOmAgain);
  }
}

}  // namespace sdfgrid::mesh_io
