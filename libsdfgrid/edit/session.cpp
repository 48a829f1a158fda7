#include "sdfgrid/edit/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <system_error>

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
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw Error(ErrorKind::failed, folder + ": " + failed.message());
  SessionLock lock(folder, SessionLock::Use::writing);
  check_is_new(folder);  // another process may have been faster
  remove_leftovers(folder);
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
  if (!reads) remove_leftovers(folder_);
  read_journal_file();
  read_records();
  replay(job);
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

// The latest snapshot whose strokes all still stand; returns how many they are.
std::size_t Session::best_snapshot(Grid& grid) {
  for (const Snapshot& snapshot : find_snapshots(folder_)) {
    // Of another journal, one that was salvaged since, say.
    if (snapshot.records > records_.size() || snapshot.records == 0) continue;
    if (snapshot.journal != records_[snapshot.records - 1].hash) continue;
    StandingStrokes then;
    for (std::size_t i = 1; i < snapshot.records; ++i) {
      then.follow(read_record(records_[i].text, i, file("journal")), i);
    }
    const std::vector<std::size_t>& now = standing_.done;
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

void Session::replay(const Job& job) {
  Grid grid;
  const std::size_t from = best_snapshot(grid);
  sculptor_.reset();
  spill_ = std::make_unique<SpillFile>(folder_);
  sculpt_.undo = options_.undo;
  sculpt_.undo.store = spill_.get();
  if (options_.read_only) {
    sculpt_.undo.full_bytes = 0;
  } else {
    // A stroke that cannot be recorded is taken back.
    sculpt_.undo.full_bytes = std::max<std::size_t>(sculpt_.undo.full_bytes, 1);
  }
  sculptor_ = std::make_unique<Sculptor>(grid, sculpt_);
  const std::vector<std::size_t>& done = standing_.done;
  for (std::size_t i = from; i < done.size(); ++i) {
    apply_record(done[i], job);
    job.report("replay", static_cast<double>(i + 1) / static_cast<double>(done.size()));
  }
  since_snapshot_ = done.size() - from;
}

void Session::apply_record(std::size_t number, const Job& job) {
  const std::string journal = file("journal");
  const SessionRecord record = read_record(records_[number].text, number, journal);
  const Stroke stroke =
      read_recorded_stroke(record.stroke, number, journal, {options_.stamps, folder_, true});
  (void)sculptor_->apply(stroke, job);
}

std::vector<std::string> Session::texts_of(const std::vector<std::size_t>& numbers) const {
  std::vector<std::string> texts;
  texts.reserve(numbers.size());
  for (const std::size_t number : numbers) {
    texts.push_back(read_record(records_[number].text, number, file("journal")).stroke);
  }
  return texts;
}

std::string Session::recorded_text(const Stroke& stroke) {
  if (stroke.text.empty()) {
    throw Error(ErrorKind::usage, "a stroke of a session needs a text to be recorded by");
  }
  if (stroke.stamps.empty()) return stroke.text;
  if (options_.stamps == nullptr) {
    throw Error(ErrorKind::usage, "this session was opened without a maker of stamps");
  }
  std::vector<std::string> names;
  for (const Stamp& stamp : stroke.stamps) {
    names.push_back("stamps/" + options_.stamps->keep(stamp, file("stamps")));
  }
  return with_stamp_files(stroke.text, names);
}

void Session::check_writable() const {
  if (journal_ == nullptr) {
    throw Error(ErrorKind::usage, folder_ + ": the session was opened for reading only");
  }
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
  StrokeReport report = sculptor_->apply(stroke, job);
  try {
    record("stroke " + text);
  } catch (...) {
    sculptor_->take_back();
    throw;
  }
  if (++since_snapshot_ >= options_.snapshot_every) snapshot();
  return report;
}

// The journal alone is enough, so a snapshot that fails is no loss.
void Session::snapshot() {
  since_snapshot_ = 0;
  try {
    compact(grid());
    write_snapshot(grid(), folder_, records_.size(), journal_->hash());
    remove_leftovers(folder_);
  } catch (const std::exception& e) {
    warnings_.push_back(
        fmt::format("no snapshot was made ({}); opening will take longer", e.what()));
  }
}

std::size_t Session::undo(std::size_t count, const Job& job) {
  check_writable();
  count = std::min(count, standing_.done.size());
  if (count == 0) return 0;
  record(fmt::format("undo {}", count));
  if (sculptor_->history().undoable() < count) {
    replay(job);
    return count;
  }
  for (std::size_t i = 0; i < count; ++i) sculptor_->undo();
  return count;
}

std::size_t Session::redo(std::size_t count, const Job& job) {
  check_writable();
  count = std::min(count, standing_.undone.size());
  if (count == 0) return 0;
  record(fmt::format("redo {}", count));
  // They are the last that stand now.
  for (std::size_t i = standing_.done.size() - count; i < standing_.done.size(); ++i) {
    if (!sculptor_->redo()) apply_record(standing_.done[i], job);
  }
  return count;
}

}  // namespace sdfgrid
