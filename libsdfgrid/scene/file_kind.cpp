#include "sdfgrid/scene/file_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/file_name.h"
#include "sdfgrid/image/stack.h"
#include "sdfgrid/mesh/read.h"
#include "sdfgrid/scene/scene.h"
#include "sdfgrid/volume/read.h"

namespace sdfgrid {
namespace {

namespace fs = std::filesystem;

bool is_one_of(const std::string& extension, const std::vector<std::string>& all) {
  return std::find(all.begin(), all.end(), extension) != all.end();
}

// Of a plain file: a pipe gives its bytes but once.
std::string beginning_of(const std::string& path) {
  std::error_code none;
  if (!fs::is_regular_file(path, none)) return "";
  std::string text(1U << 16U, '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text;
}

// Whether a YAML or JSON text gives the key a value, at the beginning of a line or of a map.
bool has_key(std::string_view text, std::string_view key) {
  constexpr std::string_view kBlank = " \t\r\"'";
  for (std::size_t at = text.find(key); at != std::string_view::npos; at = text.find(key, at + 1)) {
    const std::size_t before = text.substr(0, at).find_last_not_of(kBlank);
    const std::size_t after = text.find_first_not_of(kBlank, at + key.size());
    const bool begins = before == std::string_view::npos || text[before] == '\n' ||
                        text[before] == '{' || text[before] == ',';
    if (begins && after != std::string_view::npos && text[after] == ':') return true;
  }
  return false;
}

// "bunny.off" -> "bunny.vdb".
std::string as_grid(const std::string& path) {
  fs::path name = fs::path(path).lexically_normal();
  if (!name.has_filename()) name = name.parent_path();  // of a folder's
  return name.filename().replace_extension(".vdb").string();
}

}  // namespace

FileKind kind_of_file(const std::string& path) {
  std::error_code none;
  if (fs::is_directory(path, none)) {
    return fs::is_regular_file(path + "/journal", none) ? FileKind::session : FileKind::folder;
  }
  if (!fs::exists(path, none)) return FileKind::missing;
  const std::string begins = beginning_of(path);
  const std::string extension = extension_of(path);
  if (begins.starts_with(" BDV")) return FileKind::grid;
  if (begins.starts_with("NanoVDB") || extension == ".nvdb") return FileKind::nanovdb;
  if (has_key(begins, "sdfgrid-strokes")) return FileKind::strokes;
  if (is_one_of(extension, scene_extensions()) && has_key(begins, "sdfgrid")) {
    return FileKind::scene;
  }
  if (is_one_of(extension, mesh_extensions())) return FileKind::mesh;
  if (is_volume_name(path) || is_stack_name(path)) return FileKind::volume;
  return FileKind::other;
}

std::string_view noun_of(FileKind kind) {
  switch (kind) {
    case FileKind::missing:
      return "missing";
    case FileKind::mesh:
      return "a mesh";
    case FileKind::grid:
      return "a grid";
    case FileKind::nanovdb:
      return "a NanoVDB file";
    case FileKind::volume:
      return "a volume";
    case FileKind::scene:
      return "a scene";
    case FileKind::strokes:
      return "a stroke file";
    case FileKind::session:
      return "the folder of a session";
    case FileKind::folder:
      return "a folder";
    case FileKind::other:
      break;
  }
  return "of no kind that is known";
}

std::string way_to_grid(FileKind kind, const std::string& path) {
  switch (kind) {
    case FileKind::mesh:
    case FileKind::scene:
      return fmt::format("make a grid of it by `sdfgrid convert {} -o {}`", path, as_grid(path));
    case FileKind::volume:
    case FileKind::folder:
      return fmt::format("make a grid of it by `sdfgrid convert {} --iso V -o {}`", path,
                         as_grid(path));
    case FileKind::nanovdb:
      return "such files are written, but not read; give the .vdb of the same";
    case FileKind::strokes:
      return fmt::format("apply it to a grid by `sdfgrid sculpt GRID.vdb --strokes {} -o OUT.vdb`",
                         path);
    case FileKind::session:
      return fmt::format(
          "go on with it by `sdfgrid sculpt --session {0} --resume`, or get its grid "
          "by `sdfgrid sculpt --session {0} --export {1}`",
          path, as_grid(path));
    default:
      return "";
  }
}

void check_kind(const std::string& path, const std::string& name, FileKind wanted,
                std::initializer_list<FileKind> words) {
  const FileKind kind = kind_of_file(path);
  if (kind == wanted) return;
  const auto word_of = [](FileKind one) { return noun_of(one).substr(2); };
  if (std::find(words.begin(), words.end(), kind) != words.end()) {
    throw input_error(path, "", fmt::format("it is {}", noun_of(kind)),
                      fmt::format("write {{{}: {{file: {}}}}}", word_of(kind), name));
  }
  const std::string way = way_to_grid(kind, path);
  if (way.empty()) return;
  throw input_error(path, "", fmt::format("it is {}, no {}", noun_of(kind), word_of(wanted)),
                    way + (wanted == FileKind::grid ? "" : ", and name that under `grid`"));
}

void check_is_grid(const std::string& path) { check_kind(path, "", FileKind::grid, {}); }

void check_is_strokes(const std::string& path) {
  const FileKind kind = kind_of_file(path);
  if (kind == FileKind::missing || kind == FileKind::strokes || kind == FileKind::other) return;
  const std::string begins = "give a text that begins with 'sdfgrid-strokes: 1'";
  throw input_error(path, "", fmt::format("it is {}, no stroke file", noun_of(kind)),
                    kind == FileKind::grid || kind == FileKind::scene
                        ? fmt::format("{}; a {} is put down by a stroke with {{op: stamp, brush: "
                                      "{{{}: {{file: {}}}}}}}",
                                      begins, noun_of(kind).substr(2), noun_of(kind).substr(2),
                                      fs::path(path).filename().string())
                        : begins);
}

}  // namespace sdfgrid
