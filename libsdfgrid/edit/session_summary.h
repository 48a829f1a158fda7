// edit/session_summary.h: what the folder of a session holds, without its strokes being replayed.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sdfgrid/edit/sculptor.h"

namespace sdfgrid {

struct SessionSummary {
  std::size_t records = 0;           // of strokes, undos and redos
  std::vector<std::string> strokes;  // the texts of those that stand
  std::size_t redoable = 0;
  std::size_t snapshots = 0;  // from which opening it begins
  Redistance redistance = Redistance::local;
  bool torn = false;     // the last record is not complete
  bool damaged = false;  // behind these records: the session opens with --salvage only
};

// Reads the journal alone. Throws Error{input} if there is none, or its first record is damaged or
// of a newer version.
[[nodiscard]] SessionSummary summarize_session(const std::string& folder);

}  // namespace sdfgrid
