#include "sdfgrid/image/stack.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <vector>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/memory.h"

namespace sdfgrid {
namespace {

namespace fs = std::filesystem;

bool is_tiff(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension == ".tif" || extension == ".tiff";
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Names with numbers in them as people count: slice9 before slice10.
bool natural_less(const std::string& a, const std::string& b) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
      continue;
    }
    const auto number = [](const std::string& text, std::size_t& at) {
      while (at < text.size() && text[at] == '0') ++at;
      const std::size_t start = at;
      while (at < text.size() && is_digit(text[at])) ++at;
      return text.substr(start, at - start);
    };
    const std::string x = number(a, i);
    const std::string y = number(b, j);
    if (x.size() != y.size()) return x.size() < y.size();
    if (x != y) return x < y;
  }
  return a.size() - i < b.size() - j;
}

// One picture of the stack: a file, or a page of it.
struct Slice {
  std::string file;
  int page = 0;
};

std::unique_ptr<OIIO::ImageInput> open(const std::string& file) {
  auto input = OIIO::ImageInput::open(file);
  if (!input) {
    throw input_error(file, "", "it is no picture that can be read (" + OIIO::geterror() + ")",
                      "leave only the slices, complete, in the folder");
  }
  return input;
}

std::vector<Slice> find_slices(const std::string& path) {
  std::vector<Slice> slices;
  if (!fs::is_directory(path)) {
    const auto input = open(path);
    while (input->seek_subimage(static_cast<int>(slices.size()), 0)) {
      slices.push_back({path, static_cast<int>(slices.size())});
    }
    return slices;
  }
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(path)) {
    const bool hidden = entry.path().filename().string().starts_with(".");
    if (entry.is_regular_file() && !hidden) files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end(), natural_less);
  for (std::string& file : files) slices.push_back({std::move(file), 0});
  if (slices.empty()) {
    throw input_error(path, "", "the folder holds no files", "name a folder of slices");
  }
  return slices;
}

// Samples of the type that OpenImageIO calls so; half becomes float.
Samples samples_of(const std::string& file, const OIIO::TypeDesc& type) {
  switch (type.basetype) {
    case OIIO::TypeDesc::UINT8:
      return std::vector<std::uint8_t>();
    case OIIO::TypeDesc::INT8:
      return std::vector<std::int8_t>();
    case OIIO::TypeDesc::UINT16:
      return std::vector<std::uint16_t>();
    case OIIO::TypeDesc::INT16:
      return std::vector<std::int16_t>();
    case OIIO::TypeDesc::UINT32:
      return std::vector<std::uint32_t>();
    case OIIO::TypeDesc::INT32:
      return std::vector<std::int32_t>();
    case OIIO::TypeDesc::HALF:
    case OIIO::TypeDesc::FLOAT:
      return std::vector<float>();
    case OIIO::TypeDesc::DOUBLE:
      return std::vector<double>();
    default:
      break;
  }
  throw input_error(file, "", fmt::format("pixels of type {}", type.c_str()),
                    "convert it to 8 or 16 bits or float");
}

OIIO::TypeDesc type_of(const Samples& samples) {
  constexpr OIIO::TypeDesc::BASETYPE kTypes[] = {
      OIIO::TypeDesc::UINT8,  OIIO::TypeDesc::INT8,  OIIO::TypeDesc::UINT16, OIIO::TypeDesc::INT16,
      OIIO::TypeDesc::UINT32, OIIO::TypeDesc::INT32, OIIO::TypeDesc::UINT64, OIIO::TypeDesc::INT64,
      OIIO::TypeDesc::FLOAT,  OIIO::TypeDesc::DOUBLE};
  return kTypes[samples.index()];
}

std::string place_of(const Slice& slice) {
  return slice.page > 0 ? fmt::format("page {}", slice.page + 1) : "";
}

void check_slice(const Slice& slice, const OIIO::ImageSpec& spec, const Volume& volume) {
  if (spec.nchannels > 2) {
    throw input_error(slice.file, place_of(slice), fmt::format("{} channels", spec.nchannels),
                      "convert the slices to grey");
  }
  if (spec.width != volume.dims.x || spec.height != volume.dims.y || spec.depth > 1) {
    throw input_error(slice.file, place_of(slice),
                      fmt::format("{} x {} pixels where the first slice has {} x {}", spec.width,
                                  spec.height, volume.dims.x, volume.dims.y),
                      "leave slices of one size only");
  }
  if (samples_of(slice.file, spec.format).index() != volume.samples.index()) {
    throw input_error(slice.file, place_of(slice),
                      fmt::format("pixels of type {} where the first slice has {}",
                                  spec.format.c_str(), type_name(volume.samples)),
                      "convert the slices to one type");
  }
}

void read_slice(const Slice& slice, OIIO::ImageInput& input, int k, Volume& volume) {
  if (!input.seek_subimage(slice.page, 0)) {
    throw input_error(slice.file, place_of(slice), input.geterror(), "copy it again");
  }
  check_slice(slice, input.spec(), volume);
  std::visit(
      [&](auto& values) {
        if (!input.read_image(slice.page, 0, 0, 1, type_of(volume.samples),
                              values.data() + volume.place({0, 0, k}))) {
          throw input_error(slice.file, place_of(slice), input.geterror(),
                            "check that the copy is complete");
        }
      },
      volume.samples);
}

void allocate(const std::string& path, const OIIO::ImageSpec& first, std::size_t slices,
              Volume& volume) {
  constexpr int kMost = 1 << 20;
  if (first.width < 1 || first.height < 1 || first.width > kMost || first.height > kMost ||
      slices > static_cast<std::size_t>(kMost)) {
    throw input_error(path, "",
                      fmt::format("{} slices of {} x {}", slices, first.width, first.height),
                      "1 to 2^20 along each axis are possible");
  }
  volume.dims = {first.width, first.height, static_cast<int>(slices)};
  const auto bytes = static_cast<double>(volume.size() * bytes_per_sample(volume.samples));
  if (bytes > available_memory()) {
    throw Error(ErrorKind::failed,
                fmt::format("{}: reading it takes {:.1f} GB of memory, {:.1f} GB are free; scale "
                            "the slices down",
                            path, 1e-9 * bytes, 1e-9 * available_memory()));
  }
  std::visit([&](auto& values) { values.resize(volume.size()); }, volume.samples);
}

}  // namespace

bool is_stack_name(const std::string& path) {
  std::error_code ignored;
  return is_tiff(path) || fs::is_directory(path, ignored);
}

VolumeFile read_image_stack(const std::string& path, const Job& job) {
  if (!fs::exists(path)) {
    throw input_error(path, "", "there is no such file or folder", "check the path");
  }
  OIIO::attribute("threads", 1);  // threads are core/parallel's alone
  const std::vector<Slice> slices = find_slices(path);
  VolumeFile file;
  file.format = fs::is_directory(path) ? "stack of pictures" : "TIFF";
  std::unique_ptr<OIIO::ImageInput> input;
  for (std::size_t k = 0; k < slices.size(); ++k) {
    job.checkpoint();
    job.report("read", static_cast<double>(k) / static_cast<double>(slices.size()));
    if (k == 0 || slices[k].file != slices[k - 1].file) input = open(slices[k].file);
    if (k == 0) {
      file.volume.samples = samples_of(slices[k].file, input->spec().format);
      allocate(path, input->spec(), slices.size(), file.volume);
    }
    read_slice(slices[k], *input, static_cast<int>(k), file.volume);
  }
  job.report("read", 1.0);
  return file;
}

}  // namespace sdfgrid
