#include "sdfgrid/image/stack.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/file_name.h"
#include "sdfgrid/core/memory.h"
#include "sdfgrid/image/codec.h"

namespace sdfgrid {
namespace {

namespace fs = std::filesystem;

bool is_tiff(const std::string& path) {
  const std::string extension = extension_of(path);
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

std::unique_ptr<PictureInput> open(const std::string& file) {
  try {
    return picture_codec().open(file);
  } catch (const PictureError& reason) {
    throw input_error(file, "",
                      std::string("it is no picture that can be read (") + reason.what() + ")",
                      "leave only the slices, complete, in the folder");
  }
}

std::vector<Slice> find_slices(const std::string& path) {
  std::vector<Slice> slices;
  if (!fs::is_directory(path)) {
    const auto input = open(path);
    while (input->seek(static_cast<int>(slices.size()))) {
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

template <std::size_t... Is>
Samples alternative(std::size_t index, std::index_sequence<Is...> /*all*/) {
  Samples samples;
  ((Is == index ? static_cast<void>(samples.emplace<Is>()) : void()), ...);
  return samples;
}

// Empty samples of the picture's type.
Samples samples_of(const std::string& file, const PictureSpec& spec) {
  if (spec.type == PixelType::other) {
    throw input_error(file, "", "pixels of type " + spec.type_name,
                      "convert it to 8 or 16 bits or float");
  }
  constexpr std::size_t kTypes = std::variant_size_v<Samples>;
  static_assert(kTypes == static_cast<std::size_t>(PixelType::other));
  return alternative(static_cast<std::size_t>(spec.type), std::make_index_sequence<kTypes>());
}

std::string place_of(const Slice& slice) {
  return slice.page > 0 ? fmt::format("page {}", slice.page + 1) : "";
}

void check_slice(const Slice& slice, const PictureSpec& spec, const Volume& volume) {
  if (spec.channels.size() > 2) {
    throw input_error(slice.file, place_of(slice), fmt::format("{} channels", spec.channels.size()),
                      "convert the slices to grey");
  }
  if (spec.width != volume.dims.x || spec.height != volume.dims.y || spec.depth > 1) {
    throw input_error(slice.file, place_of(slice),
                      fmt::format("{} x {} pixels where the first slice has {} x {}", spec.width,
                                  spec.height, volume.dims.x, volume.dims.y),
                      "leave slices of one size only");
  }
  if (samples_of(slice.file, spec).index() != volume.samples.index()) {
    throw input_error(slice.file, place_of(slice),
                      fmt::format("pixels of type {} where the first slice has {}", spec.type_name,
                                  type_name(volume.samples)),
                      "convert the slices to one type");
  }
}

void read_slice(const Slice& slice, PictureInput& input, int k, Volume& volume) {
  try {
    if (!input.seek(slice.page)) throw PictureError("the page is missing");
    check_slice(slice, input.spec(), volume);
    const auto type = static_cast<PixelType>(volume.samples.index());
    std::visit(
        [&](auto& values) {
          input.read(slice.page, 1, type, values.data() + volume.place({0, 0, k}));
        },
        volume.samples);
  } catch (const PictureError& reason) {
    throw input_error(slice.file, place_of(slice), reason.what(),
                      "check that the copy is complete");
  }
}

void allocate(const std::string& path, const PictureSpec& first, std::size_t slices,
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
  check_fits(bytes, path + ": reading it", "scale the slices down");
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
  const std::vector<Slice> slices = find_slices(path);
  VolumeFile file;
  file.format = fs::is_directory(path) ? "stack of pictures" : "TIFF";
  std::unique_ptr<PictureInput> input;
  for (std::size_t k = 0; k < slices.size(); ++k) {
    job.checkpoint();
    job.report("read", static_cast<double>(k) / static_cast<double>(slices.size()));
    if (k == 0 || slices[k].file != slices[k - 1].file) input = open(slices[k].file);
    if (k == 0) {
      file.volume.samples = samples_of(slices[k].file, input->spec());
      allocate(path, input->spec(), slices.size(), file.volume);
    }
    read_slice(slices[k], *input, static_cast<int>(k), file.volume);
  }
  job.report("read", 1.0);
  return file;
}

}  // namespace sdfgrid
