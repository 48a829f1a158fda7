// NRRD by teem; declared in read_formats.h. The header is read first and alone, so that no memory
// is taken for samples that are not there.
#include <fmt/format.h>
#include <teem/nrrd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>

#include "sdfgrid/core/error.h"
#include "sdfgrid/volume/read_formats.h"

namespace sdfgrid::volume_io {
namespace {

namespace fs = std::filesystem;

struct FreeNrrd {
  void operator()(Nrrd* nrrd) const { nrrdNuke(nrrd); }
};
struct FreeState {
  void operator()(NrrdIoState* state) const { nrrdIoStateNix(state); }
};

// One file as teem sees it.
struct Loaded {
  std::unique_ptr<Nrrd, FreeNrrd> nrrd{nrrdNew()};
  std::unique_ptr<NrrdIoState, FreeState> state{nrrdIoStateNew()};
};

// The innermost of teem's messages.
std::string teem_message() {
  const std::unique_ptr<char, decltype(&std::free)> text(biffGetDone(NRRD), &std::free);
  std::string message = text ? text.get() : "";
  while (!message.empty() && message.back() == '\n') message.pop_back();
  const std::size_t line = message.find_last_of('\n');
  if (line != std::string::npos) message.erase(0, line + 1);
  const std::size_t name = message.find(": ");
  return name == std::string::npos ? message : message.substr(name + 2);
}

Loaded load(const std::string& path, bool header_only) {
  Loaded loaded;
  loaded.state->skipData = header_only ? 1 : 0;
  if (nrrdLoad(loaded.nrrd.get(), path.c_str(), loaded.state.get()) != 0) {
    throw input_error(path, header_only ? "header" : "samples", teem_message(),
                      header_only ? "correct the header" : kCopyAgain);
  }
  return loaded;
}

void check_magic(const std::string& path) {
  std::array<char, 4> magic{};
  std::ifstream(path, std::ios::binary).read(magic.data(), magic.size());
  if (std::memcmp(magic.data(), "NRRD", magic.size()) != 0) {
    throw input_error(path, "line 1", "it does not begin with 'NRRD'", "check the file's format");
  }
}

// Bytes behind the empty line that ends an attached header.
std::uint64_t attached_bytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string line;
  std::uint64_t used = 0;
  while (std::getline(in, line)) {
    used += line.size() + 1;
    if (line.empty() || line == "\r") return file_size(path) - std::min(used, file_size(path));
  }
  return 0;
}

// Names of detached files: those listed, or those that a pattern makes of a range of numbers.
std::vector<std::string> data_files(const std::string& path, const NrrdIoState& state) {
  std::vector<std::string> names;
  for (unsigned i = 0; i < state.dataFNArr->len; ++i) names.emplace_back(state.dataFN[i]);
  if (state.dataFNFormat != nullptr) {
    constexpr long kMost = 100000;
    const long step = state.dataFNStep;
    const long count = step == 0 ? kMost + 1 : (long{state.dataFNMax} - state.dataFNMin) / step + 1;
    if (count < 1 || count > kMost) {
      throw input_error(path, "header", fmt::format("a pattern for {} data files", count),
                        "correct its range of numbers");
    }
    for (long i = 0; i < count; ++i) {
      std::array<char, 4096> name{};
      // teem has seen to it that the pattern holds one %d and nothing else.
      std::snprintf(name.data(), name.size(), state.dataFNFormat,
                    static_cast<int>(state.dataFNMin + i * step));
      names.emplace_back(name.data());
    }
  }
  return names;
}

std::uint64_t available_bytes(const std::string& path, const NrrdIoState& state) {
  const std::vector<std::string> names = data_files(path, state);
  if (names.empty()) return attached_bytes(path);
  std::uint64_t bytes = 0;
  for (const std::string& name : names) {
    const fs::path file(name);
    bytes += file_size(file.is_absolute() ? name : (fs::path(path).parent_path() / file).string());
  }
  return bytes;
}

// How many bytes of samples one byte of the file can make at most.
double best_ratio(const NrrdIoState& state, std::size_t sample_bytes) {
  if (state.encoding == nrrdEncodingGzip) return kDeflateRatio;
  if (state.encoding == nrrdEncodingBzip2) return 30000;  // 900 kB of one value make 40 bytes
  // A digit and a space a sample, and no space behind the last.
  if (state.encoding == nrrdEncodingAscii) return static_cast<double>(sample_bytes) + 1;
  return state.encoding == nrrdEncodingHex ? 0.5 : 1;
}

Samples samples_of(const std::string& path, int type) {
  switch (type) {
    case nrrdTypeChar:
      return std::vector<std::int8_t>();
    case nrrdTypeUChar:
      return std::vector<std::uint8_t>();
    case nrrdTypeShort:
      return std::vector<std::int16_t>();
    case nrrdTypeUShort:
      return std::vector<std::uint16_t>();
    case nrrdTypeInt:
      return std::vector<std::int32_t>();
    case nrrdTypeUInt:
      return std::vector<std::uint32_t>();
    case nrrdTypeLLong:
      return std::vector<std::int64_t>();
    case nrrdTypeULLong:
      return std::vector<std::uint64_t>();
    case nrrdTypeFloat:
      return std::vector<float>();
    case nrrdTypeDouble:
      return std::vector<double>();
    default:
      break;
  }
  throw input_error(path, "header", "its samples are blocks, not numbers", "export numbers");
}

// The axes that count: all, or those longer than one sample if there are more than three.
std::vector<unsigned> space_axes(const std::string& path, const Nrrd& nrrd) {
  std::vector<unsigned> axes;
  for (unsigned a = 0; a < nrrd.dim; ++a) {
    if (nrrd.dim <= 3 || nrrd.axis[a].size > 1) axes.push_back(a);
  }
  if (axes.size() > 3) {
    throw input_error(path, "header", fmt::format("it has {} axes", nrrd.dim),
                      "take one volume of three axes out of it, as by 'unu slice'");
  }
  for (unsigned a = 0; axes.size() < 3 && a < nrrd.dim; ++a) {
    if (std::find(axes.begin(), axes.end(), a) == axes.end()) axes.push_back(a);
  }
  std::sort(axes.begin(), axes.end());
  return axes;
}

// Spacing and origin of an axis that has no direction in space.
void set_axis(const NrrdAxisInfo& axis, int a, Volume& volume) {
  double spacing = axis.spacing;
  const bool has_range = std::isfinite(axis.min) && std::isfinite(axis.max);
  const bool cells = axis.center != nrrdCenterNode;
  if (!std::isfinite(spacing) && has_range) {
    const auto steps =
        static_cast<double>(cells ? axis.size : std::max<std::size_t>(axis.size, 2) - 1);
    spacing = (axis.max - axis.min) / steps;
  }
  volume.spacing[a] = std::isfinite(spacing) ? spacing : 1.0;
  if (std::isfinite(axis.min)) {
    volume.origin[a] = axis.min + (cells ? 0.5 * volume.spacing[a] : 0.0);
  }
}

void set_geometry(const std::string& path, const Nrrd& nrrd, const std::vector<unsigned>& axes,
                  Volume& volume) {
  const bool oriented = nrrd.spaceDim == 3 && axes.size() == 3 &&
                        std::all_of(axes.begin(), axes.end(), [&](unsigned a) {
                          return std::isfinite(nrrd.axis[a].spaceDirection[0]);
                        });
  if (!oriented) {
    for (std::size_t a = 0; a < axes.size(); ++a) {
      set_axis(nrrd.axis[axes[a]], static_cast<int>(a), volume);
    }
    return;
  }
  glm::dmat3 steps(1.0);
  for (int a = 0; a < 3; ++a) {
    for (int row = 0; row < 3; ++row) steps[a][row] = nrrd.axis[axes[a]].spaceDirection[row];
    if (std::isfinite(nrrd.spaceOrigin[a])) volume.origin[a] = nrrd.spaceOrigin[a];
  }
  set_axes(path, steps, volume);
}

}  // namespace

VolumeFile read_nrrd(const std::string& path, const Job& job) {
  (void)file_size(path);
  check_magic(path);
  static std::mutex teem;  // its messages are global
  const std::lock_guard lock(teem);
  nrrdStateVerboseIO = 0;
  VolumeFile file;
  Volume& volume = file.volume;
  {
    const Loaded header = load(path, true);
    const std::vector<unsigned> axes = space_axes(path, *header.nrrd);
    volume.samples = samples_of(path, header.nrrd->type);
    std::array<std::uint64_t, 3> dims = {1, 1, 1};
    for (std::size_t a = 0; a < axes.size(); ++a) dims[a] = header.nrrd->axis[axes[a]].size;
    const std::uint64_t bytes = set_dims(path, dims, volume);
    check_claim(path, bytes, available_bytes(path, *header.state),
                best_ratio(*header.state, bytes_per_sample(volume.samples)));
    set_geometry(path, *header.nrrd, axes, volume);
    file.format = fmt::format("NRRD {}", header.state->encoding->name);
  }
  allocate(path, volume, 1);
  job.checkpoint();
  job.report("read", 0.0);
  const Loaded loaded = load(path, false);
  job.checkpoint();
  std::visit(
      [&](auto& values) {
        std::memcpy(values.data(), loaded.nrrd->data, values.size() * sizeof(values[0]));
      },
      volume.samples);
  return file;
}

}  // namespace sdfgrid::volume_io
