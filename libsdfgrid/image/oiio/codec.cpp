// The module behind image/codec.h: all that sdfgrid has of OpenImageIO. It throws and returns
// nothing but what that header and the standard library know.
#include "sdfgrid/image/codec.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <array>
#include <cstddef>
#include <utility>

namespace sdfgrid {
namespace {

// In the order of PixelType.
constexpr std::array<OIIO::TypeDesc::BASETYPE, 10> kTypes = {
    OIIO::TypeDesc::UINT8,  OIIO::TypeDesc::INT8,  OIIO::TypeDesc::UINT16, OIIO::TypeDesc::INT16,
    OIIO::TypeDesc::UINT32, OIIO::TypeDesc::INT32, OIIO::TypeDesc::UINT64, OIIO::TypeDesc::INT64,
    OIIO::TypeDesc::FLOAT,  OIIO::TypeDesc::DOUBLE};

OIIO::TypeDesc oiio_type(PixelType type) { return kTypes.at(static_cast<std::size_t>(type)); }

PixelType pixel_type(const OIIO::TypeDesc& type) {
  if (type.basetype == OIIO::TypeDesc::HALF) return PixelType::f32;
  for (std::size_t i = 0; i < kTypes.size(); ++i) {
    if (type.basetype == kTypes[i]) return static_cast<PixelType>(i);
  }
  return PixelType::other;
}

class Input final : public PictureInput {
 public:
  explicit Input(std::unique_ptr<OIIO::ImageInput> file) : file_(std::move(file)) {}

  [[nodiscard]] PictureSpec spec() const override {
    const OIIO::ImageSpec& spec = file_->spec();
    return {spec.width,
            spec.height,
            spec.depth,
            spec.channelnames,
            pixel_type(spec.format),
            spec.format.c_str(),
            spec.get_string_attribute("oiio:ColorSpace") == "sRGB"};
  }
  [[nodiscard]] bool seek(int page) override { return file_->seek_subimage(page, 0); }
  void read(int page, int channels, PixelType type, void* pixels) override {
    if (!file_->read_image(page, 0, 0, channels, oiio_type(type), pixels)) {
      throw PictureError(file_->geterror());
    }
  }

 private:
  std::unique_ptr<OIIO::ImageInput> file_;
};

class Codec final : public PictureCodec {
 public:
  Codec() {
    OIIO::attribute("threads", 1);  // threads are core/parallel's alone
    OIIO::attribute("exr_threads", -1);
  }

  [[nodiscard]] std::unique_ptr<PictureInput> open(const std::string& path) const override {
    auto file = OIIO::ImageInput::open(path);
    if (!file) throw PictureError(OIIO::geterror());
    return std::make_unique<Input>(std::move(file));
  }

  // To memory, since OpenImageIO's PNG writer does not notice a full disk.
  [[nodiscard]] std::vector<unsigned char> encode(const std::string& path, const PictureSpec& spec,
                                                  const void* pixels) const override {
    const OIIO::TypeDesc type = oiio_type(spec.type);
    OIIO::ImageSpec file_spec(spec.width, spec.height, static_cast<int>(spec.channels.size()),
                              type);
    file_spec.channelnames = spec.channels;
    file_spec.attribute("oiio:ColorSpace", spec.srgb ? "sRGB" : "Linear");
    // EXR's; other formats have one way, or their own names for them.
    if (type == OIIO::TypeDesc::FLOAT) file_spec.attribute("compression", "zip");
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const auto output = OIIO::ImageOutput::create(path, &memory);
    if (!output) throw PictureError(OIIO::geterror());
    if (!output->open(path, file_spec) || !output->write_image(type, pixels) || !output->close()) {
      throw PictureError(output->geterror());
    }
    return bytes;
  }
};

}  // namespace
}  // namespace sdfgrid

extern "C" __attribute__((visibility("default"))) const sdfgrid::PictureCodec*
sdfgrid_picture_codec() {
  static const sdfgrid::Codec codec;
  return &codec;
}
