// mesh/read_om_filter.h: what may be handed to OpenMesh's reader, which trusts its file (not
// installed).
#pragma once

#include <string>

#include "sdfgrid/mesh/read_formats.h"

namespace sdfgrid::mesh_io {

inline constexpr const char* kSaveOmAgain = "save it again with OpenMesh 9, or as PLY";

// The chunks of an OM file that make its surface, as an OM file of their own: whole, of the
// announced counts, with finite coordinates. Indices are not checked. Throws Error{input}.
[[nodiscard]] std::string filter_om(const Source& source);

}  // namespace sdfgrid::mesh_io
