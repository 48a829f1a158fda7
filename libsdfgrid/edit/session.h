// edit/session.h: sculpting that a crash cannot harm. A session is a folder:
//
//   base.vdb           the grid that it began with
//   journal            one record a stroke, undo or redo (edit/journal.h)
//   snapshot-N.vdb     the grid after the first N records, so that opening need not replay them all
//   stamps/            copies of the grids and scenes that strokes used, named by their contents
//   lock               held by the one process that has the session open
//
// What a call acknowledged by returning is on the disk. A session opens with every acknowledged
// stroke, wherever the process was when it was killed: strokes give the same bits whenever they are
// applied.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/edit/journal.h"
#include "sdfgrid/edit/sculptor.h"
#include "sdfgrid/edit/spill_file.h"
#include "sdfgrid/edit/stamp.h"

namespace sdfgrid {

struct SessionOptions {
  // Goes on from the last good record of a damaged journal, which is kept as journal.damaged.
  bool salvage = false;
  std::size_t snapshot_every = 500;  // strokes
  StampMaker* stamps = nullptr;      // must outlive the session; none: strokes with stamps fail
  UndoOptions undo{};                // without a store: the session has a file for it
};

// Makes a session of `grid` in a folder that does not exist or is empty. Throws Error{usage} if
// there is a session already, Error{input} for a grid that cannot be sculpted, Error{failed} if it
// cannot be written.
void create_session(const std::string& folder, const Grid& grid, Redistance redistance);

class Session {
 public:
  // Throws Error{failed} if another process has it open, Error{input} if there is no session or it
  // is damaged (naming the record, and what can be saved).
  Session(std::string folder, const SessionOptions& options, const Job& job);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // Applies a stroke that has a text (edit/stroke_file.h), records it and returns. If it cannot be
  // recorded the grid is as before, and Error{failed} is thrown.
  StrokeReport apply(const Stroke& stroke, const Job& job);
  // The text that apply() records: the stroke's, with copies in this session of its stamps, which
  // are made if they are not there yet. Throws Error{failed}.
  [[nodiscard]] std::string recorded_text(const Stroke& stroke);
  // Undo, or redo, that many strokes or as many as there are; return how many.
  std::size_t undo(std::size_t count, const Job& job);
  std::size_t redo(std::size_t count, const Job& job);

  [[nodiscard]] const std::vector<std::string>& strokes() const { return done_; }   // that stand
  [[nodiscard]] const std::vector<std::string>& undone() const { return undone_; }  // last first
  [[nodiscard]] const std::vector<JournalRecord>& log() const { return records_; }
  // What was cut off or could not be written, since it was opened.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  [[nodiscard]] const Grid& grid() const { return sculptor_->grid(); }
  // Of the strokes since it was opened; others are undone by replaying those before.
  [[nodiscard]] const UndoHistory& history() const { return sculptor_->history(); }

 private:
  class Lock;
  void read_journal_file();
  void read_header(const std::string& text);
  void replay(const Job& job);
  std::size_t best_snapshot(const std::vector<std::size_t>& standing, Grid& grid) const;
  [[nodiscard]] Stroke parse(const std::string& text, const std::string& source) const;
  void record(const std::string& text);
  void snapshot();
  [[nodiscard]] std::string file(const std::string& name) const { return folder_ + "/" + name; }

  std::string folder_;
  SessionOptions options_;
  std::unique_ptr<Lock> lock_;
  SculptOptions sculpt_;
  std::unique_ptr<Journal> journal_;
  std::vector<JournalRecord> records_;
  std::vector<std::string> done_;
  std::vector<std::string> undone_;
  std::size_t since_snapshot_ = 0;
  std::vector<std::string> warnings_;
  std::unique_ptr<SpillFile> spill_;
  std::unique_ptr<Sculptor> sculptor_;
};

}  // namespace sdfgrid
