#include "sdfgrid/edit/session_summary.h"

#include <algorithm>

#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/journal.h"
#include "sdfgrid/edit/session_records.h"
#include "sdfgrid/edit/snapshots.h"

namespace sdfgrid {

SessionSummary summarize_session(const std::string& folder) {
  const std::string journal = folder + "/journal";
  const JournalContent content = read_journal(journal);
  if (content.records.empty()) {
    throw input_error(journal, "record 0", "it is damaged, and says how the session began",
                      "begin a new session with base.vdb of this one");
  }
  SessionSummary summary;
  summary.redistance = read_start(content.records[0].text, journal).redistance;
  summary.records = content.records.size() - 1;
  summary.torn = content.torn();
  summary.damaged = content.damaged();
  StandingStrokes standing;
  for (std::size_t i = 1; i < content.records.size(); ++i) {
    standing.follow(read_record(content.records[i].text, i, journal), i);
  }
  for (const std::size_t number : standing.done) {
    summary.strokes.push_back(read_record(content.records[number].text, number, journal).stroke);
  }
  summary.redoable = standing.undone.size();
  const std::vector<Snapshot> all = find_snapshots(folder);
  summary.snapshots = static_cast<std::size_t>(std::count_if(
      all.begin(), all.end(), [&](const Snapshot& s) { return is_of(s, content.records); }));
  return summary;
}

}  // namespace sdfgrid
