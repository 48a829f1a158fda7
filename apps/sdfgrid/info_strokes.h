// apps/sdfgrid/info_strokes.h: what `info` says of sessions and stroke files.
#pragma once

#include <string>

#include "command.h"
#include "sdfgrid/core/lattice.h"

namespace sdfgrid::cli {

// The folder of a session: its strokes, and how to go on with it.
void report_session(const std::string& folder, Context& context);

// A stroke file: its strokes.
void report_strokes(const std::string& path, Context& context);

// `bounds` of the result, null if it is empty.
void report_bounds(const Box& box, Context& context);

}  // namespace sdfgrid::cli
