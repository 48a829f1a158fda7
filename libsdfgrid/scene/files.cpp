#include "sdfgrid/scene/files.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>

#include "sdfgrid/core/error.h"
#include "sdfgrid/image/image.h"
#include "sdfgrid/volume/read.h"

namespace sdfgrid {
namespace {

std::vector<glm::dvec3> points_of_array(const std::string& path, const Job& job) {
  const Volume volume = read_volume(path, std::nullopt, job).volume;
  if (volume.dims.y != 3 || volume.dims.z != 1) {
    throw input_error(path, "header", "it is no array of n x 3 numbers", "give one point a row");
  }
  const auto n = static_cast<std::size_t>(volume.dims.x);
  std::vector<glm::dvec3> points(n);
  std::visit(
      [&](const auto& values) {
        for (std::size_t i = 0; i < n; ++i) {
          for (std::size_t a = 0; a < 3; ++a) {
            points[i][static_cast<int>(a)] = static_cast<double>(values[a * n + i]);
          }
        }
      },
      volume.samples);
  return points;
}

// The numbers of a line, separated by blanks or commas; false if something else stands there.
bool read_numbers(std::string_view line, std::vector<double>& numbers) {
  numbers.clear();
  line = line.substr(0, line.find('#'));
  constexpr std::string_view kBetween = " \t,;\r";
  for (;;) {
    const std::size_t begin = line.find_first_not_of(kBetween);
    if (begin == std::string_view::npos) return true;
    line.remove_prefix(begin);
    double v = 0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), v);
    const auto length = static_cast<std::size_t>(end - line.data());
    const bool ends =
        length == line.size() || kBetween.find(line[length]) != std::string_view::npos;
    if (error != std::errc() || !ends || !std::isfinite(v)) return false;
    numbers.push_back(v);
    line.remove_prefix(length);
  }
}

std::vector<glm::dvec3> points_of_text(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw input_error(path, "", "it cannot be read", "check the path");
  std::vector<glm::dvec3> points;
  std::vector<double> numbers;
  std::string line;
  for (int n = 1; std::getline(in, line); ++n) {
    const bool good = read_numbers(line, numbers);
    if (good && numbers.empty()) continue;
    if (!good || numbers.size() != 3) {
      throw input_error(path, fmt::format("line {}", n), "here stand no three numbers",
                        "give x, y and z, one point a line");
    }
    points.emplace_back(numbers[0], numbers[1], numbers[2]);
  }
  return points;
}

}  // namespace

std::vector<glm::dvec3> read_points(const std::string& path, const Job& job) {
  return path.ends_with(".npy") ? points_of_array(path, job) : points_of_text(path);
}

Heights read_heights(const std::string& path) {
  const Image image = read_image(path, false, kMostHeights);
  const auto pixels =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  const std::size_t channels = image.channels.size();
  const std::size_t grey = channels < 3 ? 1 : 3;  // beyond them alpha and others
  Heights heights;
  heights.width = image.width;
  heights.samples.resize(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t c = 0; c < grey; ++c) heights.samples[i] += image.pixels[i * channels + c];
    heights.samples[i] /= static_cast<double>(grey);
    if (!std::isfinite(heights.samples[i])) {
      throw input_error(path, "", "a pixel is no finite number", "mend the picture");
    }
  }
  return heights;
}

}  // namespace sdfgrid
