// edit/session.h: sculpting that a crash cannot harm. A session is a folder:
//
//   base.vdb           the grid that it began with
//   journal            one record a stroke, undo or redo (edit/journal.h, edit/session_records.h)
//   snapshot-*.vdb     grids on the way (edit/snapshots.h)
//   stamps/            copies of the grids and scenes that strokes used, named by their contents
//   lock               held by the one process that changes the session (edit/session_lock.h)
//   journal.torn*, journal.damaged*    what was cut off the journal, and journals before a salvage
//
// What a call acknowledged by returning is on the disk. A session opens with every acknowledged
// stroke, wherever the process was when it was killed: strokes give the same bits whenever they are
// applied.
#pragma once

#include <cstdint>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/edit/journal.h"
#include "sdfgrid/edit/sculptor.h"
#include "sdfgrid/edit/session_lock.h"
#include "sdfgrid/edit/session_records.h"
#include "sdfgrid/edit/spill_file.h"
#include "sdfgrid/edit/stamp.h"

namespace sdfgrid {

struct SessionOptions {
  // Changes nothing in the folder, which needs no permission to write: nothing can be applied,
  // undone or redone, and a torn record stays where it is. Others may read at the same time.
  bool read_only = false;
  // Goes on from the last good record of a damaged journal, which is kept as journal.damaged.
  bool salvage = false;
  std::size_t snapshot_every = 500;  // strokes
  StampMaker* stamps = nullptr;      // must outlive the session; none: strokes with stamps fail
  UndoOptions undo{};  // without a store: the session has a file for it; the last stroke is kept
};

// Makes a session of `grid` in a folder that does not exist or is empty (but for what a creation
// left that was interrupted), and returns its lock, which was held from before the first byte.
// Throws Error{usage} if there is a session already or anything else, Error{input} for a grid that
// cannot be sculpted, Error{failed} if it cannot be written or another process is at it.
SessionLock create_session(const std::string& folder, const Grid& grid, Redistance redistance);

class Session {
 public:
  // `lock`: of create_session(); without one it is taken. Throws Error{failed} if another process
  // has it open, Error{input} if there is no session or it is damaged (naming the record, and what
  // can be saved) or made by a newer version.
  Session(std::string folder, const SessionOptions& options, const Job& job, SessionLock lock = {});
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // Applies a stroke that has a text (edit/stroke_file.h), records it and returns. If it cannot be
  // recorded all is as before, and Error{failed} is thrown. Throws Error{usage} for a stroke with
  // words that are not known, for what Sculptor refuses, and if it was opened for reading only.
  StrokeReport apply(const Stroke& stroke, const Job& job);
  // The text that apply() records: the stroke's, with the names of the copies in this session that
  // apply() makes of its stamps.
  [[nodiscard]] std::string recorded_text(const Stroke& stroke) const;
  // Undo, or redo, that many strokes or as many as there are; return how many. If they throw
  // (Error{cancelled} while strokes are replayed, Error{failed}), nothing was undone or redone; the
  // grid is that of the records. Should it be impossible to make that again, the session has no
  // grid any more: this call throws what went wrong first, later ones Error{failed}, and the
  // records, which are whole, can be opened again. Undoing strokes that history() does not hold
  // replays those before into a second grid: while that lasts, memory holds both.
  std::size_t undo(std::size_t count, const Job& job);
  std::size_t redo(std::size_t count, const Job& job);

  // The texts of the strokes that stand, and of those that can be redone, the next of them last.
  [[nodiscard]] std::vector<std::string> strokes() const { return texts_of(standing_.done); }
  [[nodiscard]] std::vector<std::string> undone() const { return texts_of(standing_.undone); }
  [[nodiscard]] const std::vector<JournalRecord>& log() const { return records_; }
  // What was cut off or could not be written, since it was opened.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  [[nodiscard]] Redistance redistance() const { return sculpt_.redistance; }
  [[nodiscard]] const Grid& grid() const { return sculptor().grid(); }
  // Of the strokes since it was opened; others are undone by replaying those before.
  [[nodiscard]] const UndoHistory& history() const { return sculptor().history(); }

 private:
  void read_journal_file();
  void keep_what_is_cut(const JournalContent& content);
  void read_records();
  // The grid as strokes left it.
  struct Work {
    std::unique_ptr<SpillFile> spill;  // before the sculptor, which uses it
    std::unique_ptr<Sculptor> sculptor;
    std::size_t since_snapshot = 0;
  };
  Work replay(const std::vector<std::size_t>& done, const Job& job);
  std::size_t best_snapshot(const std::vector<std::size_t>& now, Grid& grid);
  void apply_record(Sculptor& sculptor, std::size_t number, const Job& job);
  bool undo_again(std::size_t redone);
  void make_again(const std::exception_ptr& cause);
  void record(const std::string& text);
  void snapshot();
  void check_writable() const;
  [[nodiscard]] const Sculptor& sculptor() const;
  [[nodiscard]] std::vector<std::string> texts_of(const std::vector<std::size_t>& numbers) const;
  [[nodiscard]] std::string file(const std::string& name) const { return folder_ + "/" + name; }

  std::string folder_;
  SessionOptions options_;
  SessionLock lock_;
  SculptOptions sculpt_;
  std::unique_ptr<Journal> journal_;  // none if it is only read
  std::vector<JournalRecord> records_;
  StandingStrokes standing_;
  Work work_;
  std::vector<std::string> warnings_;
};

}  // namespace sdfgrid
