// scene/file_kind.h: what a file is, by its name and how it begins, so that who names one of
// another kind is told what it is and what to do with it.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

namespace sdfgrid {

enum class FileKind : std::uint8_t {
  missing,
  mesh,
  grid,     // OpenVDB
  nanovdb,  // which is only written
  volume,   // a TIFF too
  scene,
  strokes,
  session,  // the folder of one
  folder,   // any other: of pictures, perhaps
  other,
};

[[nodiscard]] FileKind kind_of_file(const std::string& path);

// "a mesh", "a stroke file", ...
[[nodiscard]] std::string_view noun_of(FileKind kind);

// What to do to have a grid of it, "" if nothing is known.
[[nodiscard]] std::string way_to_grid(FileKind kind, const std::string& path);

// Throw Error{input} that says what the file is instead, and the remedy, for what is known to be no
// grid, no mesh or no stroke file: to be called before it is read as one.
void check_is_grid(const std::string& path);
void check_is_strokes(const std::string& path);
// The same of a file that is named, by `name`, under the word of one kind, where those of `words`
// might stand: another of these is told its own word.
void check_kind(const std::string& path, const std::string& name, FileKind wanted,
                std::initializer_list<FileKind> words);

}  // namespace sdfgrid
