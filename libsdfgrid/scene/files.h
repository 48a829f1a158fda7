// scene/files.h: what scenes read beside grids and meshes: points, pictures of heights.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "sdfgrid/core/job.h"

namespace sdfgrid {

// The rows of an n x 3 array (.npy), or of a text with three numbers a line (# begins a comment).
// Throws Error{input} with line or header and the remedy.
[[nodiscard]] std::vector<glm::dvec3> read_points(const std::string& path, const Job& job);

// Grey values row by row from the top, 0 black and 1 white, as the picture stores them; of a
// coloured one the mean of red, green and blue.
struct Heights {
  int width = 0;
  std::vector<double> samples;
};
inline constexpr std::size_t kMostHeights = 1U << 22U;  // samples

// Throws Error{input} for what is no picture or has more than kMostHeights pixels.
[[nodiscard]] Heights read_heights(const std::string& path);

}  // namespace sdfgrid
