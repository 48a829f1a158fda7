// image/codec.h: the little that this room asks of OpenImageIO, whose 260 libraries take 0.18 s to
// load. They are behind a module of their own, oiio/codec.cpp, that is loaded when the first
// picture is read or written, so that whoever has no picture does not wait for them. Internal to
// image/.
#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace sdfgrid {

// In the order of the alternatives of Samples (volume/volume.h).
enum class PixelType : std::uint8_t { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64, other };

struct PictureSpec {
  int width = 0;
  int height = 0;
  int depth = 1;
  std::vector<std::string> channels;
  PixelType type = PixelType::other;  // of its pixels; f32 for half
  std::string type_name;              // as OpenImageIO calls it
  bool srgb = false;                  // whether its codes are sRGB's
};

// What went wrong, in OpenImageIO's words.
struct PictureError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A file that is open for reading. All throw PictureError.
class PictureInput {
 public:
  PictureInput() = default;
  PictureInput(const PictureInput&) = delete;
  PictureInput& operator=(const PictureInput&) = delete;
  virtual ~PictureInput() = default;
  [[nodiscard]] virtual PictureSpec spec()
      const = 0;                                  // of the page that was sought last, or the first
  [[nodiscard]] virtual bool seek(int page) = 0;  // false if there is none
  // Converts the first `channels` channels of a page to `type`, row by row from the upper left.
  virtual void read(int page, int channels, PixelType type, void* pixels) = 0;
};

class PictureCodec {
 public:
  PictureCodec() = default;
  PictureCodec(const PictureCodec&) = delete;
  PictureCodec& operator=(const PictureCodec&) = delete;
  virtual ~PictureCodec() = default;
  // Throws PictureError if `path` is no picture that can be read.
  [[nodiscard]] virtual std::unique_ptr<PictureInput> open(const std::string& path) const = 0;
  // The bytes of a file whose format the extension of `path` names, of pixels of spec.type, which
  // is stored as it is. Throws PictureError.
  [[nodiscard]] virtual std::vector<unsigned char> encode(const std::string& path,
                                                          const PictureSpec& spec,
                                                          const void* pixels) const = 0;
};

// Loads the module the first time. Throws Error{failed} if it is not where it was installed.
[[nodiscard]] const PictureCodec& picture_codec();

// The module's one symbol.
inline constexpr const char* kPictureCodecSymbol = "sdfgrid_picture_codec";
using PictureCodecEntry = const PictureCodec* (*)();

}  // namespace sdfgrid
