#include "sdfgrid/image/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <span>

#include "sdfgrid/core/atomic_file.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/core/memory.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/image/codec.h"

namespace sdfgrid {
namespace {

std::string extension(const std::string& path) {
  std::string text = std::filesystem::path(path).extension().string();
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

bool is_alpha(const std::string& channel) { return channel == "A"; }

// Threshold in (0, 1) of an 8 x 8 ordered dither: the bits of x ^ y and y, interleaved in reverse.
float dither(int x, int y) {
  unsigned rank = 0;
  for (unsigned bit = 0; bit < 3; ++bit) {
    const unsigned a = (static_cast<unsigned>(x ^ y) >> bit) & 1U;
    const unsigned b = (static_cast<unsigned>(y) >> bit) & 1U;
    rank |= (a << 1U | b) << (2 * (2 - bit));
  }
  return (static_cast<float>(rank) + 0.5F) / 64.0F;
}

void encode_row(const Image& image, int y, std::uint8_t* out) {
  const std::size_t channels = image.channels.size();
  for (int x = 0; x < image.width; ++x) {
    for (std::size_t c = 0; c < channels; ++c) {
      const bool alpha = is_alpha(image.channels[c]);
      const float value = image.at(x, y, static_cast<int>(c));
      const float clipped = value > 0 ? std::min(value, 1.0F) : 0.0F;  // NaN is black
      const float code = 255.0F * (alpha ? clipped : srgb_from_linear(clipped));
      *out++ = static_cast<std::uint8_t>(std::min(code + (alpha ? 0.5F : dither(x, y)), 255.0F));
    }
  }
}

std::vector<std::uint8_t> encode_8bit(const Image& image) {
  std::vector<std::uint8_t> bytes(image.pixels.size());
  const std::size_t row = image.width * image.channels.size();
  parallel_for(image.height, 16, Job(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      encode_row(image, static_cast<int>(y), bytes.data() + y * row);
    }
  });
  return bytes;
}

void check_png_channels(const std::string& path, const std::vector<std::string>& channels) {
  const std::vector<std::string> rgba = {"R", "G", "B", "A"};
  const bool fits = (channels.size() == 3 || channels.size() == 4) &&
                    std::equal(channels.begin(), channels.end(), rgba.begin());
  if (!fits) {
    throw Error(ErrorKind::usage,
                path + ": a .png holds the channels R, G, B and A only; write an .exr");
  }
}

std::vector<unsigned char> encode(const std::string& path, const PictureSpec& spec,
                                  const void* pixels) {
  try {
    return picture_codec().encode(path, spec, pixels);
  } catch (const PictureError& reason) {
    throw Error(ErrorKind::failed, path + ": cannot be written (" + reason.what() + ")");
  }
}

void decode_srgb(Image& image) {
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (is_alpha(image.channels[i % image.channels.size()])) continue;
    image.pixels[i] = linear_from_srgb(image.pixels[i]);
  }
}

}  // namespace

const std::vector<std::string>& image_extensions() {
  static const std::vector<std::string> all = {".png", ".exr"};
  return all;
}

bool holds_any_channel(const std::string& path) { return extension(path) == ".exr"; }

void write_image(const std::string& path, const Image& image) {
  const std::string kind = extension(path);
  if (std::ranges::find(image_extensions(), kind) == image_extensions().end()) {
    throw Error(ErrorKind::usage,
                path + ": pictures are written as .png or .exr; choose one of these extensions");
  }
  const std::size_t expected =
      static_cast<std::size_t>(std::max(image.width, 0)) * std::max(image.height, 0);
  if (expected == 0 || image.pixels.size() != expected * image.channels.size()) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: {} values do not make a picture of {} x {} with {} channels", path,
                            image.pixels.size(), image.width, image.height, image.channels.size()));
  }
  const bool png = kind == ".png";
  if (png) check_png_channels(path, image.channels);

  PictureSpec spec;
  spec.width = image.width;
  spec.height = image.height;
  spec.channels = image.channels;
  spec.type = png ? PixelType::u8 : PixelType::f32;
  spec.srgb = png;
  const std::vector<unsigned char> bytes = encode(
      path, spec, png ? static_cast<const void*>(encode_8bit(image).data()) : image.pixels.data());
  write_bytes_atomically(path, std::as_bytes(std::span(bytes)));
}

Image read_image(const std::string& path, bool decode, std::size_t most_pixels) {
  try {
    const auto input = picture_codec().open(path);
    const PictureSpec spec = input->spec();
    Image image{spec.width, spec.height, spec.channels, {}};
    const auto channels = static_cast<int>(spec.channels.size());
    const std::size_t pixels = static_cast<std::size_t>(spec.width) * spec.height;
    if (spec.depth > 1) throw PictureError("it is a volume, not a picture");
    if (pixels > most_pixels) {
      throw input_error(path, "",
                        fmt::format("{} x {} pixels are too many", spec.width, spec.height),
                        fmt::format("scale it down to {} pixels", most_pixels));
    }
    check_fits(static_cast<double>(pixels) * channels * sizeof(float), path + ": reading it",
               "scale the picture down");
    image.pixels.resize(pixels * channels);
    input->read(0, channels, PixelType::f32, image.pixels.data());
    if (decode && spec.srgb) decode_srgb(image);
    return image;
  } catch (const PictureError& reason) {
    throw input_error(path, "", reason.what(), "check the path and that the copy is complete");
  }
}

float srgb_from_linear(float linear) {
  return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1 / 2.4F) - 0.055F;
}

float linear_from_srgb(float code) {
  return code <= 0.04045F ? code / 12.92F : std::pow((code + 0.055F) / 1.055F, 2.4F);
}

}  // namespace sdfgrid
