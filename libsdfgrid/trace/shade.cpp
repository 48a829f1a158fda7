#include "sdfgrid/trace/shade.h"

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <numeric>
#include <string_view>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/trace/atlas_seen.h"
#include "sdfgrid/trace/edges.h"
#include "sdfgrid/trace/shader.h"

namespace sdfgrid {
namespace {

constexpr int kFarNodes = 64;  // along the longest side of the far field

void check(const Camera& camera, const HitBuffer& hits, const Look& look) {
  if (look.samples < 1 || look.samples > 256) {
    throw Error(ErrorKind::usage, fmt::format("{} samples a pixel: give 1 to 256", look.samples));
  }
  if (hits.width != camera.width || hits.height != camera.height) {
    throw Error(ErrorKind::usage,
                fmt::format("hits of {} x {} pixels do not belong to a camera of {} x {}",
                            hits.width, hits.height, camera.width, camera.height));
  }
}

// Runs row(y) for all rows of a picture.
template <class Row>
void for_rows(int height, std::string_view step, const Job& job, const Row& row) {
  parallel_for(step, static_cast<std::size_t>(height), 1, job,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t y = begin; y < end; ++y) row(y);
               });
}

// One sample through the centre of every pixel of a row.
void shade_row(const Shader& shader, const HitBuffer& hits, std::size_t y, Picture& picture) {
  const auto width = static_cast<std::size_t>(hits.width);
  std::vector<Sample> samples(width);
  for (std::size_t x = 0; x < width; ++x) {
    samples[x] = {static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5,
                  hits.depth[y * width + x]};
  }
  shader(samples, std::span(picture.color).subspan(y * width, width),
         std::span(picture.normal).subspan(y * width, width),
         std::span(picture.material).subspan(y * width, width));
}

// The i-th of n places in a pixel, (i + 0.5) / n across and the bit-reversed i down (Hammersley).
Sample place_in_pixel(std::size_t x, std::size_t y, int i, int n) {
  double down = 0;
  double digit = 0.5;
  for (int rest = i; rest > 0; rest >>= 1, digit *= 0.5) down += (rest & 1) != 0 ? digit : 0;
  return {static_cast<double>(x) + (i + 0.5) / n, static_cast<double>(y) + down + 0.5 / n, 0.0F};
}

// Replaces the colours of a row's edge pixels by the mean of n samples.
void refine_row(const Shader& shader, const Seen& seen, const RayGenerator& rays,
                const std::vector<std::uint8_t>& edges, int n, std::size_t y, Picture& picture) {
  const auto width = static_cast<std::size_t>(picture.width);
  std::vector<Sample> samples;
  std::vector<Ray> through;
  std::vector<std::size_t> pixels;
  for (std::size_t x = 0; x < width; ++x) {
    if (edges[y * width + x] == 0) continue;
    pixels.push_back(y * width + x);
    for (int i = 0; i < n; ++i) {
      samples.push_back(place_in_pixel(x, y, i, n));
      through.push_back(rays.ray(samples.back().x, samples.back().y));
    }
  }
  std::vector<float> depth(samples.size());
  seen.trace(through, depth);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].depth = depth[i];
  std::vector<glm::vec3> colors(samples.size());
  shader(samples, colors, {}, {});
  for (std::size_t p = 0; p < pixels.size(); ++p) {
    const auto first = colors.begin() + static_cast<std::ptrdiff_t>(p) * n;
    picture.color[pixels[p]] =
        std::accumulate(first, first + n, glm::vec3(0.0F)) / static_cast<float>(n);
  }
}

}  // namespace

Surroundings make_surroundings(const Atlas& atlas, const Job& job) {
  // The visibility kernel's lanes index samples with 32 bits.
  if (atlas.samples.size() > std::size_t{std::numeric_limits<std::int32_t>::max()}) {
    throw Error(ErrorKind::failed,
                fmt::format("{:.1f} million bricks are more than the 2.9 million that can be "
                            "shaded; use a coarser voxel",
                            1e-6 * static_cast<double>(atlas.samples.size()) / Atlas::kSamples));
  }
  Surroundings surroundings;
  surroundings.points = surface_points(atlas, job);
  surroundings.far = make_far_field(atlas, surroundings.points, kFarNodes, job);
  return surroundings;
}

Picture shade(const Atlas& atlas, const Surroundings& surroundings, const Camera& camera,
              const HitBuffer& hits, const Look& look, const Job& job) {
  return shade(SeenAtlas(atlas, look.material), atlas, surroundings, camera, hits, look, job);
}

Picture shade(const Seen& seen, const Atlas& atlas, const Surroundings& surroundings,
              const Camera& camera, const HitBuffer& hits, const Look& look, const Job& job) {
  check(camera, hits, look);
  const Shader shader(seen, atlas, surroundings, camera, look);
  Picture picture{hits.width, hits.height, {}, {}, {}, 0};
  picture.color.resize(hits.size());
  picture.normal.resize(hits.size());
  picture.material.resize(hits.size());
  for_rows(hits.height, "shade", job, [&](std::size_t y) { shade_row(shader, hits, y, picture); });
  if (look.samples == 1) return picture;

  const std::vector<std::uint8_t> edges = edge_pixels(hits, picture, camera, job);
  picture.refined = std::accumulate(edges.begin(), edges.end(), std::size_t{0});
  const RayGenerator rays(camera);
  for_rows(hits.height, "smooth edges", job,
           [&](std::size_t y) { refine_row(shader, seen, rays, edges, look.samples, y, picture); });
  return picture;
}

}  // namespace sdfgrid
