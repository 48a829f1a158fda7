// edit/snapshots.h: grids that a session keeps on its way, so that opening it need not replay all
// strokes. The journal alone is enough, so one that is lost does no harm; one that was changed is
// noticed. Their names say all that must fit:
//
//   snapshot-RECORDS-JOURNAL-CONTENTS.vdb     how many records it holds, the hash of the last of
//                                             them (and so of all), the hash of the file
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sdfgrid/edit/journal.h"
#include "sdfgrid/grid/grid.h"

namespace sdfgrid {

struct Snapshot {
  std::string path;
  std::size_t records = 0;
  std::uint64_t journal = 0;
  std::uint64_t contents = 0;
};

// Those in `folder`, the ones with most records first.
[[nodiscard]] std::vector<Snapshot> find_snapshots(const std::string& folder);

// Throws Error{input} if the file is not what was written.
[[nodiscard]] Grid read_snapshot(const Snapshot& snapshot);

// Makes one of the grid after so many records. Throws Error{failed}.
void write_snapshot(const Grid& grid, const std::string& folder, std::size_t records,
                    std::uint64_t journal);

// Whether the snapshot is of the journal with these records, not of one before a salvage, say.
[[nodiscard]] bool is_of(const Snapshot& snapshot, const std::vector<JournalRecord>& records);

// Removes what nobody needs: unfinished files of processes that were killed, and all snapshots but
// the newest two of the journal with these records. Only for who has the session to himself.
void remove_leftovers(const std::string& folder, const std::vector<JournalRecord>& records);

// Whether a file of that name is an unfinished one (core/atomic_file.h).
[[nodiscard]] bool is_unfinished(const std::string& name);

}  // namespace sdfgrid
