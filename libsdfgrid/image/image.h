// image/image.h: pictures in and out. OpenImageIO stands behind it, in image.cpp alone.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace sdfgrid {

// A picture in linear light (sRGB primaries, 1 is the white of a display) with any further
// channels.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::string> channels;  // "R", "G", "B", "depth.Z", ...
  // Row by row from the upper left corner, the channels of a pixel beside each other.
  std::vector<float> pixels;

  [[nodiscard]] float& at(int x, int y, int channel) { return pixels[index(x, y, channel)]; }
  [[nodiscard]] float at(int x, int y, int channel) const { return pixels[index(x, y, channel)]; }

 private:
  [[nodiscard]] std::size_t index(int x, int y, int channel) const {
    const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + x;
    return pixel * channels.size() + channel;
  }
};

// The extensions that write_image knows, lower case with the dot.
[[nodiscard]] const std::vector<std::string>& image_extensions();

// Whether a picture of this name can hold channels beyond R, G, B and A, and values beyond [0, 1].
[[nodiscard]] bool holds_any_channel(const std::string& path);

// Writes `image` to `path`, which appears whole or not at all.
// .exr: every channel as 32-bit float, unchanged. .png: R, G, B and perhaps A, in 8 bits; colours
// are encoded to sRGB, clipped to [0, 1] and dithered by an 8 x 8 ordered pattern so that soft
// gradients show no bands. Throws Error{usage} for another extension, channels that the format
// cannot hold or pixels that do not match the size; Error{failed} if it cannot be written.
void write_image(const std::string& path, const Image& image);

// Reads any picture that OpenImageIO reads; files encoded in sRGB are decoded to linear light, or
// left as they are stored (heights, say) unless `decode`. Throws Error{input} for what is no
// picture or has more than `most_pixels`, before they are read, and Error{failed} if the memory
// does not suffice.
[[nodiscard]] Image read_image(const std::string& path, bool decode = true,
                               std::size_t most_pixels = std::size_t{1} << 40);

// The sRGB transfer function (IEC 61966-2-1): linear light in [0, 1] to code value in [0, 1], and
// back.
[[nodiscard]] float srgb_from_linear(float linear);
[[nodiscard]] float linear_from_srgb(float code);

}  // namespace sdfgrid
