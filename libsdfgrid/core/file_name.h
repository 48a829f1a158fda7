// core/file_name.h: what the name of a file says.
#pragma once

#include <string>

namespace sdfgrid {

// ".vdb" of "a/b.VDB": in small letters, with its dot; "" if there is none.
[[nodiscard]] std::string extension_of(const std::string& path);

}  // namespace sdfgrid
