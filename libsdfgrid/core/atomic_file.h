// core/atomic_file.h: output files that appear whole or not at all.
#pragma once

#include <functional>
#include <string>

namespace sdfgrid {

// Calls write(temporary), where `temporary` is a new name beside `path` with the same extension,
// then flushes it to disk and renames it to `path`. If anything throws, the temporary is removed
// and `path` is as it was. Throws Error{failed} if the folder cannot be written.
void write_atomically(const std::string& path,
                      const std::function<void(const std::string& temporary)>& write);

// Removes the temporaries of calls that are under way, for a program that must end before they do;
// what still writes to them then writes to nothing.
void remove_temporaries() noexcept;

}  // namespace sdfgrid
