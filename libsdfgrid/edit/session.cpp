#include "sdfgrid/edit/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <system_error>

#include "sdfgrid/core/atomic_file.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/snapshots.h"
#include "sdfgrid/edit/stroke_file.h"

namespace sdfgrid {
namespace {

namespace fs = std::filesystem;

// Throws if anything is in the folder but what a creation leaves that was interrupted: its lock
// and, behind that, its base and unfinished files.
void check_is_new(const std::string& folder) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) throw Error(ErrorKind::usage, folder + ": it is not a folder");
  if (fs::exists(folder + "/journal")) {
    throw Error(ErrorKind::usage, folder + ": there is a session already; open it with --resume");
  }
  const bool interrupted = fs::exists(folder + "/lock");
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool ours = name == "lock" || name == "base.vdb" || is_unfinished(name);
    if (interrupted && ours) continue;
    throw Error(ErrorKind::usage, folder + ": the folder is not empty; give another one");
  }
}

}  // namespace

SessionLock create_session(const std::string& folder, const Grid& grid, Redistance redistance) {
  SessionStart start{redistance, 0, Sculptor(grid).range()};
  check_is_new(folder);
  create_folders(folder);
  SessionLock lock(folder, SessionLock::Use::writing);
  check_is_new(folder);  // another process may have been faster
  remove_leftovers(folder, {});
  write_grid(grid, folder + "/base.vdb");
  start.base_hash = fnv_hash_of_file(folder + "/base.vdb");
  create_journal(folder + "/journal", start_text(start));
  return lock;
}

Session::Session(std::string folder, const SessionOptions& options, const Job& job,
                 SessionLock lock)
    : folder_(std::move(folder)), options_(options), lock_(std::move(lock)) {
  if (!fs::exists(file("journal"))) {
    throw input_error(folder_, "", "there is no session",
                      "begin one with 'sdfgrid sculpt GRID --session DIR'");
  }
  const bool reads = options_.read_only;
  if (!lock_.held()) {
    lock_ = SessionLock(folder_, reads ? SessionLock::Use::reading : SessionLock::Use::writing);
  }
  read_journal_file();
  read_records();
  if (!reads) remove_leftovers(folder_, records_);
  work_ = replay(standing_.done, job);
}

Session::~Session() = default;

void Session::read_journal_file() {
  JournalContent content = read_journal(file("journal"));
  const std::string place =
      fmt::format("record {} (byte {})", content.records.size(), content.good_bytes);
  if (content.records.empty()) {
    const std::size_t after = content.records_after_damage;
    throw input_error(
        file("journal"), place,
        "it is damaged, and says how the session began, so nothing can be replayed; " +
            (after == 0 ? std::string("no other record can be read")
                        : fmt::format("the {} records after it can be read", after)),
        std::string("begin a new session with base.vdb of this one") +
            (after == 0 ? "" : " and a stroke file of those records' texts"));
  }
  if (content.damaged() && !options_.salvage) {
    const std::string after = content.records_after_damage == 0
                                  ? std::string("there is none after it")
                                  : fmt::format("the {} after it cannot be replayed without it",
                                                content.records_after_damage);
    throw input_error(file("journal"), place,
                      fmt::format("it is damaged; the {} records before it are good, {}",
                                  content.records.size() - 1, after),
                      "open the session with --resume --salvage to go on from the good ones (the "
                      "journal is kept)");
  }
  if (options_.read_only && content.torn()) {
    warnings_.push_back(fmt::format(
        "{}: {} is not complete and does not count; the next command that changes the session cuts "
        "it off",
        file("journal"), place));
  }
  if (!options_.read_only) {
    keep_what_is_cut(content);
    journal_ = std::make_unique<Journal>(file("journal"), content);
  }
  records_ = std::move(content.records);
}

void Session::keep_what_is_cut(const JournalContent& content) {
  const std::string place = fmt::format("{}: record {} (byte {})", file("journal"),
                                        content.records.size(), content.good_bytes);
  if (content.damaged()) {
    warnings_.push_back(fmt::format(
        "{} was damaged; went on from the {} records before it, the whole is kept as {}", place,
        content.records.size() - 1, keep_copy(file("journal"), 0, "damaged")));
  } else if (content.torn()) {
    warnings_.push_back(fmt::format("{} was not complete and was cut off; it is kept as {}", place,
                                    keep_copy(file("journal"), content.good_bytes, "torn")));
  }
}

void Session::read_records() {
  const SessionStart start = read_start(records_.front().text, file("journal"));
  sculpt_.redistance = start.redistance;
  sculpt_.range = start.range;
  if (start.base_hash != fnv_hash_of_file(file("base.vdb"))) {
    throw input_error(file("base.vdb"), "", "it is not the grid that the session began with",
                      "restore it from a copy");
  }
  for (std::size_t i = 1; i < records_.size(); ++i) {
    standing_.follow(read_record(records_[i].text, i, file("journal")), i);
  }
}

// The latest snapshot whose strokes are all among those; returns how many they are.
std::size_t Session::best_snapshot(const std::vector<std::size_t>& now, Grid& grid) {
  for (const Snapshot& snapshot : find_snapshots(folder_)) {
    if (!is_of(snapshot, records_)) continue;
    StandingStrokes then;
    for (std::size_t i = 1; i < snapshot.records; ++i) {
      then.follow(read_record(records_[i].text, i, file("journal")), i);
    }
    if (then.done.size() > now.size()) continue;
    if (!std::equal(then.done.begin(), then.done.end(), now.begin())) continue;
    try {
      grid = read_snapshot(snapshot);
      return then.done.size();
    } catch (const Error& e) {
      warnings_.push_back(std::string(e.what()) + "; its strokes were replayed");
    }
  }
  grid = read_grid(file("base.vdb"));
  return 0;
}

Session::Work Session::replay(const std::vector<std::size_t>& done, const Job& job) {
  Grid grid;
  const std::size_t from = best_snapshot(done, grid);
  Work work;
  work.spill = std::make_unique<SpillFile>(folder_);
  SculptOptions sculpt = sculpt_;
  sculpt.undo = options_.undo;
  sculpt.undo.store = work.spill.get();
  if (options_.read_only) {
    sculpt.undo.full_bytes = 0;
  } else {
    // A stroke that cannot be recorded is taken back.
    sculpt.undo.full_bytes = std::max<std::size_t>(sculpt.undo.full_bytes, 1);
  }
  work.sculptor = std::make_unique<Sculptor>(grid, sculpt);
  for (std::size_t i = from; i < done.size(); ++i) {
    apply_record(*work.sculptor, done[i], job);
    job.report("replay", static_cast<double>(i + 1) / static_cast<double>(done.size()));
  }
  work.since_snapshot = done.size() - from;
  return work;
}

void Session::apply_record(Sculptor& sculptor, std::size_t number, const Job& job) {
  const std::string journal = file("journal");
  const SessionRecord record = read_record(records_[number].text, number, journal);
  const Stroke stroke =
      read_recorded_stroke(record.stroke, number, journal, {options_.stamps, folder_, true});
  (void)sculptor.apply(stroke, job);
}

std::vector<std::string> Session::texts_of(const std::vector<std::size_t>& numbers) const {
  std::vector<std::string> texts;
  texts.reserve(numbers.size());
  for (const std::size_t number : numbers) {
    texts.push_back(read_record(records_[number].text, number, file("journal")).stroke);
  }
  return texts;
}

std::string Session::recorded_text(const Stroke& stroke) const {
  if (stroke.text.empty()) {
    throw Error(ErrorKind::usage, "a stroke of a session needs a text to be recorded by");
  }
  if (stroke.stamps.empty()) return stroke.text;
  if (options_.stamps == nullptr) {
    throw Error(ErrorKind::usage, "this session was opened without a maker of stamps");
  }
  std::vector<std::string> names;
  for (const Stamp& stamp : stroke.stamps) {
    names.push_back("stamps/" + options_.stamps->name(stamp));
  }
  return with_stamp_files(stroke.text, names);
}

void Session::check_writable() const {
  if (journal_ == nullptr) {
    throw Error(ErrorKind::usage, folder_ + ": the session was opened for reading only");
  }
  (void)sculptor();
}

const Sculptor& Session::sculptor() const {
  if (work_.sculptor == nullptr) {
    throw Error(ErrorKind::failed,
                folder_ +
                    ": its grid could not be made again after an undo or redo that failed; "
                    "its records are whole: open the session again");
  }
  return *work_.sculptor;
}

void Session::record(const std::string& text) {
  journal_->append(text);
  records_.push_back({text, journal_->hash()});
  const std::size_t number = records_.size() - 1;
  standing_.follow(read_record(text, number, file("journal")), number);
}

StrokeReport Session::apply(const Stroke& stroke, const Job& job) {
  check_writable();
  const std::string text = recorded_text(stroke);
  check_recordable(text);
  for (const Stamp& stamp : stroke.stamps) (void)options_.stamps->keep(stamp, file("stamps"));
  StrokeReport report = work_.sculptor->apply(stroke, job);
  try {
    record("stroke " + text);
  } catch (...) {
    work_.sculptor->take_back();
    throw;
  }
  if (++work_.since_snapshot >= options_.snapshot_every) snapshot();
  return report;
}

// The journal alone is enough, so a snapshot that fails is no loss.
void Session::snapshot() {
  work_.since_snapshot = 0;
  try {
    compact(grid());
    write_snapshot(grid(), folder_, records_.size(), journal_->hash());
    remove_leftovers(folder_, records_);
  } catch (const std::exception& e) {
    warnings_.push_back(
        fmt::format("no snapshot was made ({}); opening will take longer", e.what()));
  }
}

std::size_t Session::undo(std::size_t count, const Job& job) {
  check_writable();
  count = std::min(count, standing_.done.size());
  if (count == 0) return 0;
  const std::string text = fmt::format("undo {}", count);
  if (history().undoable() < count) {
    const auto left = standing_.done.end() - static_cast<std::ptrdiff_t>(count);
    Work work = replay({standing_.done.begin(), left}, job);
    record(text);
    work_ = std::move(work);
    return count;
  }
  record(text);
  try {
    for (std::size_t i = 0; i < count; ++i) work_.sculptor->undo();
  } catch (const std::exception& e) {  // it is recorded, so it is to be done
    make_again(std::current_exception());
    warnings_.push_back(fmt::format("{}; the strokes before were replayed", e.what()));
  }
  return count;
}

std::size_t Session::redo(std::size_t count, const Job& job) {
  check_writable();
  count = std::min(count, standing_.undone.size());
  if (count == 0) return 0;
  std::size_t redone = 0;
  try {
    for (; redone < count; ++redone) {
      const std::size_t number = standing_.undone[standing_.undone.size() - 1 - redone];
      if (!work_.sculptor->redo()) apply_record(*work_.sculptor, number, job);
    }
    record(fmt::format("redo {}", count));
  } catch (const Error&) {  // which leaves no stroke half made
    if (!undo_again(redone)) make_again(std::current_exception());
    throw;
  } catch (...) {
    make_again(std::current_exception());
    throw;
  }
  return count;
}

// Whether so many strokes that were redone could be undone again.
bool Session::undo_again(std::size_t redone) {
  try {
    while (redone > 0 && work_.sculptor->undo()) --redone;
  } catch (const std::exception&) {
    return false;
  }
  return redone == 0;
}

// Makes the grid anew that the records say, where a change left it half changed; what it was goes
// first, so that memory need not hold both. If that fails there is none, and `cause` is thrown.
void Session::make_again(const std::exception_ptr& cause) {
  work_ = Work();
  try {
    work_ = replay(standing_.done, Job());
  } catch (...) {
    std::rethrow_exception(cause);
  }
}

}  // namespace sdfgrid
