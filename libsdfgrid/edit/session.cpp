#include "sdfgrid/edit/session.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/stroke_file.h"

namespace sdfgrid {
namespace {

namespace fs = std::filesystem;

std::string_view redistance_word(Redistance redistance) {
  switch (redistance) {
    case Redistance::off:
      return "off";
    case Redistance::local:
      return "local";
    case Redistance::full:
      break;
  }
  return "full";
}

std::uint64_t hash_of_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw input_error(path, "", "it cannot be read", "restore it from a copy");
  std::uint64_t hash = fnv_hash("");
  std::vector<char> chunk(1 << 20);
  while (in.read(chunk.data(), static_cast<std::streamsize>(chunk.size())) || in.gcount() > 0) {
    hash = fnv_hash({chunk.data(), static_cast<std::size_t>(in.gcount())}, hash);
  }
  return hash;
}

std::string snapshot_name(std::size_t records) { return fmt::format("snapshot-{}.vdb", records); }

constexpr const char* kHashKey = "sdfgrid:journal";  // of the journal when a snapshot was made

// What one record does to the strokes that stand and those that are undone. T: a stroke.
template <class T>
void follow(const std::string& text, const T& stroke, std::vector<T>& done,
            std::vector<T>& undone) {
  if (text.starts_with("stroke ")) {
    done.push_back(stroke);
    undone.clear();
    return;
  }
  const bool undo = text.starts_with("undo ");
  std::size_t count = std::stoul(text.substr(5));
  std::vector<T>& from = undo ? done : undone;
  std::vector<T>& to = undo ? undone : done;
  for (; count > 0 && !from.empty(); --count) {
    to.push_back(from.back());
    from.pop_back();
  }
}

}  // namespace

// Held while it lives, by one process; the system lets go of it when the process ends, however.
class Session::Lock {
 public:
  explicit Lock(const std::string& path)
      : file_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
    if (file_ < 0) {
      throw Error(ErrorKind::failed, fmt::format("{}: {}", path, std::strerror(errno)));
    }
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
      char owner[32] = {};
      (void)!::pread(file_, owner, sizeof owner - 1, 0);
      ::close(file_);
      throw Error(ErrorKind::failed,
                  fmt::format("{}: the session is open in another process ({}); wait for it to end",
                              path, owner));
    }
    const std::string own = fmt::format("{}", ::getpid());
    (void)!::ftruncate(file_, 0);
    (void)!::pwrite(file_, own.data(), own.size(), 0);
  }
  ~Lock() { ::close(file_); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  int file_;
};

void create_session(const std::string& folder, const Grid& grid, Redistance redistance) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw Error(ErrorKind::failed, folder + ": " + failed.message());
  if (fs::exists(folder + "/journal")) {
    throw Error(ErrorKind::usage, folder + ": there is a session already; open it with --resume");
  }
  for (const auto& entry : fs::directory_iterator(folder)) {
    // What a creation that was interrupted leaves may be there.
    const std::string name = entry.path().filename().string();
    if (name == "base.vdb" || name.find(".partial-") != std::string::npos) continue;
    throw Error(ErrorKind::usage, folder + ": the folder is not empty; give another one");
  }
  const IndexBox range = Sculptor(grid).range();
  write_grid(grid, folder + "/base.vdb");
  create_journal(folder + "/journal",
                 fmt::format("session 1 {} {:016x} {} {} {} {} {} {}", redistance_word(redistance),
                             hash_of_file(folder + "/base.vdb"), range.lo.x, range.lo.y, range.lo.z,
                             range.hi.x, range.hi.y, range.hi.z));
}

Session::Session(std::string folder, const SessionOptions& options, const Job& job)
    : folder_(std::move(folder)), options_(options) {
  if (!fs::exists(file("journal"))) {
    throw input_error(folder_, "", "there is no session",
                      "begin one with 'sdfgrid sculpt GRID --session DIR'");
  }
  lock_ = std::make_unique<Lock>(file("lock"));
  read_journal_file();
  replay(job);
}

Session::~Session() = default;

void Session::read_journal_file() {
  JournalContent content = read_journal(file("journal"));
  if (content.records.empty()) {
    throw input_error(file("journal"), "record 0", "it is damaged, and no record is good",
                      "begin a new session with base.vdb of this one");
  }
  if (content.damaged()) {
    const std::string place =
        fmt::format("record {} (byte {})", content.records.size(), content.good_bytes);
    if (!options_.salvage) {
      throw input_error(
          file("journal"), place,
          fmt::format("it is damaged; the {} records before it are good, the {} after it cannot be "
                      "replayed without it",
                      content.records.size() - 1, content.records_after_damage),
          "open the session with --resume --salvage to go on from the good ones (the journal is "
          "kept)");
    }
    fs::copy_file(file("journal"), file("journal.damaged"), fs::copy_options::overwrite_existing);
    warnings_.push_back(
        fmt::format("{}: {} was damaged; went on from the {} records before it, the "
                    "whole is kept as journal.damaged",
                    file("journal"), place, content.records.size() - 1));
  } else if (content.torn()) {
    warnings_.push_back(
        fmt::format("{}: the last record, after {}, was not complete and was cut off",
                    file("journal"), content.records.size() - 1));
  }
  journal_ = std::make_unique<Journal>(file("journal"), content);
  read_header(content.records.front().text);
  records_ = std::move(content.records);
}

void Session::read_header(const std::string& text) {
  std::istringstream in(text);
  std::string word;
  std::string version;
  std::string redistance;
  std::string hash;
  IndexBox& r = sculpt_.range;
  in >> word >> version >> redistance >> hash >> r.lo.x >> r.lo.y >> r.lo.z >> r.hi.x >> r.hi.y >>
      r.hi.z;
  if (!in || word != "session" || version != "1") {
    throw input_error(file("journal"), "record 0",
                      "it is of a kind that this program does not know",
                      "open it with the version of sdfgrid that made it");
  }
  for (const Redistance mode : {Redistance::off, Redistance::local, Redistance::full}) {
    if (redistance == redistance_word(mode)) sculpt_.redistance = mode;
  }
  if (hash != fmt::format("{:016x}", hash_of_file(file("base.vdb")))) {
    throw input_error(file("base.vdb"), "", "it is not the grid that the session began with",
                      "restore it from a copy");
  }
}

// The latest snapshot whose strokes all still stand; returns how many they are. `standing`: the
// records of the strokes that stand.
std::size_t Session::best_snapshot(const std::vector<std::size_t>& standing, Grid& grid) const {
  std::vector<std::size_t> done;
  std::vector<std::size_t> undone;
  std::vector<std::pair<std::size_t, std::size_t>> usable;  // records, strokes
  for (std::size_t i = 1; i < records_.size(); ++i) {
    follow(records_[i].text, i, done, undone);
    if (!fs::exists(file(snapshot_name(i + 1)))) continue;
    const bool stands =
        done.size() <= standing.size() && std::equal(done.begin(), done.end(), standing.begin());
    if (stands) usable.emplace_back(i + 1, done.size());
  }
  std::reverse(usable.begin(), usable.end());  // the newest first
  for (const auto& [records, strokes] : usable) {
    try {
      Grid found = read_grid(file(snapshot_name(records)));
      if (found.metadata(kHashKey) != fmt::format("{:016x}", records_[records - 1].hash)) continue;
      found.remove_metadata(kHashKey);
      grid = found;
      return strokes;
    } catch (const Error&) {
      // Unreadable: an older one, or the base, serves as well.
    }
  }
  grid = read_grid(file("base.vdb"));
  return 0;
}

void Session::replay(const Job& job) {
  std::vector<std::size_t> standing;
  std::vector<std::size_t> undone;
  for (std::size_t i = 1; i < records_.size(); ++i) follow(records_[i].text, i, standing, undone);
  const auto texts = [&](const std::vector<std::size_t>& of) {
    std::vector<std::string> all;
    all.reserve(of.size());
    for (const std::size_t i : of) all.push_back(records_[i].text.substr(7));
    return all;
  };
  done_ = texts(standing);
  undone_ = texts(undone);
  Grid grid;
  const std::size_t from = best_snapshot(standing, grid);
  sculptor_.reset();
  spill_ = std::make_unique<SpillFile>(folder_);
  sculpt_.undo = options_.undo;
  sculpt_.undo.store = spill_.get();
  sculptor_ = std::make_unique<Sculptor>(grid, sculpt_);
  for (std::size_t i = from; i < done_.size(); ++i) {
    const std::string source = fmt::format("{}: record {}", file("journal"), standing[i]);
    (void)sculptor_->apply(parse(done_[i], source), job);
    job.report("replay", static_cast<double>(i + 1) / static_cast<double>(done_.size()));
  }
  since_snapshot_ = done_.size() - from;
}

Stroke Session::parse(const std::string& text, const std::string& source) const {
  return parse_stroke(text, source, {options_.stamps, folder_, true});
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

void Session::record(const std::string& text) {
  journal_->append(text);
  records_.push_back({text, journal_->hash()});
}

StrokeReport Session::apply(const Stroke& stroke, const Job& job) {
  const std::string text = recorded_text(stroke);
  StrokeReport report = sculptor_->apply(stroke, job);
  try {
    record("stroke " + text);
  } catch (...) {
    sculptor_->undo();
    throw;
  }
  done_.push_back(text);
  undone_.clear();
  if (++since_snapshot_ >= options_.snapshot_every) snapshot();
  return report;
}

// The journal alone is enough, so a snapshot that fails is no loss.
void Session::snapshot() {
  since_snapshot_ = 0;
  try {
    Grid now = grid();
    now.set_metadata(kHashKey, fmt::format("{:016x}", journal_->hash()));
    compact(now);
    write_grid(now, file(snapshot_name(records_.size())));
    now.remove_metadata(kHashKey);
  } catch (const Error& e) {
    warnings_.push_back(
        fmt::format("no snapshot was made ({}); opening will take longer", e.what()));
  }
}

std::size_t Session::undo(std::size_t count, const Job& job) {
  count = std::min(count, done_.size());
  if (count == 0) return 0;
  record(fmt::format("undo {}", count));
  if (sculptor_->history().undoable() < count) {
    replay(job);
    return count;
  }
  follow(records_.back().text, std::string(), done_, undone_);
  for (std::size_t i = 0; i < count; ++i) sculptor_->undo();
  return count;
}

std::size_t Session::redo(std::size_t count, const Job& job) {
  count = std::min(count, undone_.size());
  if (count == 0) return 0;
  record(fmt::format("redo {}", count));
  for (std::size_t i = 0; i < count; ++i) {
    const std::string text = undone_.back();
    undone_.pop_back();
    done_.push_back(text);
    if (!sculptor_->redo()) (void)sculptor_->apply(parse(text, file("journal")), job);
  }
  return count;
}

}  // namespace sdfgrid
