#include "sdfgrid/trace/edges.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "sdfgrid/core/parallel.h"

namespace sdfgrid {
namespace {

constexpr float kCrease = 0.85F;  // cosine between normals, 32 degrees
constexpr double kStep = 0.7;  // sine between a surface and the line from it to the neighbour's hit

class EdgeFinder {
 public:
  EdgeFinder(const HitBuffer& hits, const Picture& picture, const Camera& camera)
      : hits_(hits), normals_(picture.normal), materials_(picture.material), rays_(camera) {}

  [[nodiscard]] bool is_edge(int x, int y) const {
    return (x > 0 && differ(x, y, x - 1, y)) || (x + 1 < hits_.width && differ(x, y, x + 1, y)) ||
           (y > 0 && differ(x, y, x, y - 1)) || (y + 1 < hits_.height && differ(x, y, x, y + 1));
  }

 private:
  [[nodiscard]] std::size_t pixel(int x, int y) const {
    return static_cast<std::size_t>(y) * hits_.width + x;
  }

  [[nodiscard]] glm::dvec3 point(int x, int y) const {
    const Ray ray = rays_.ray(x + 0.5, y + 0.5);
    return ray.origin + static_cast<double>(hits_.depth[pixel(x, y)]) * ray.direction;
  }

  [[nodiscard]] bool differ(int ax, int ay, int bx, int by) const {
    const std::size_t a = pixel(ax, ay);
    const std::size_t b = pixel(bx, by);
    const bool hit_a = std::isfinite(hits_.depth[a]);
    const bool hit_b = std::isfinite(hits_.depth[b]);
    if (hit_a != hit_b) return true;
    if (!hit_a) return false;
    if (materials_[a] != materials_[b]) return true;
    if (glm::dot(normals_[a], normals_[b]) < kCrease) return true;
    const glm::dvec3 line = point(bx, by) - point(ax, ay);
    const double step = std::max(std::abs(glm::dot(line, glm::dvec3(normals_[a]))),
                                 std::abs(glm::dot(line, glm::dvec3(normals_[b]))));
    return step > kStep * glm::length(line);
  }

  const HitBuffer& hits_;
  const std::vector<glm::vec3>& normals_;
  const std::vector<int>& materials_;
  RayGenerator rays_;
};

}  // namespace

std::vector<std::uint8_t> edge_pixels(const HitBuffer& hits, const Picture& picture,
                                      const Camera& camera, const Job& job) {
  const EdgeFinder finder(hits, picture, camera);
  std::vector<std::uint8_t> edges(hits.size());
  parallel_for(static_cast<std::size_t>(hits.height), 8, job,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t y = begin; y < end; ++y) {
                   for (int x = 0; x < hits.width; ++x) {
                     const bool edge = finder.is_edge(x, static_cast<int>(y));
                     edges[y * hits.width + x] = edge ? 1 : 0;
                   }
                 }
               });
  return edges;
}

}  // namespace sdfgrid
