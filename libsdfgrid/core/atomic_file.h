// core/atomic_file.h: output files that appear whole or not at all.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

namespace sdfgrid {

// Calls write(temporary), where `temporary` is a new name beside `path` with the same extension,
// then flushes it to disk and renames it to `path`. Where `path` is a symbolic link, the file that
// it names is written and the link stays; a file that was there hands on its permissions. If
// anything throws, the temporary is removed and `path` is as it was. Throws Error{failed} if the
// folder cannot be written. `write` must throw if bytes did not arrive: a stream or a library that
// swallows a full disk makes half a file.
void write_atomically(const std::string& path,
                      const std::function<void(const std::string& temporary)>& write);

// Makes a folder and those above it that are missing; when this returns their names are on the
// disk. Throws Error{failed}.
void create_folders(const std::string& path);

// The path that a symbolic link leads to in the end, whether something is there or not; the path
// itself if it is no link. Throws Error{failed} for links in a circle.
[[nodiscard]] std::string follow_links(const std::string& path);

// The same for bytes that are at hand. Throws Error{failed} with the system's reason.
void write_bytes_atomically(const std::string& path, std::span<const std::byte> bytes);

// Removes the temporaries of calls that are under way, for a program that must end before they do;
// what still writes to them then writes to nothing.
void remove_temporaries() noexcept;

}  // namespace sdfgrid
