// Sessions: journals that were cut off or changed, undo over many openings, crashes, full disks.
#include "sdfgrid/edit/session.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

#include "app/process.h"
#include "edit/grids.h"
#include "edit/session_strokes.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/journal.h"
#include "sdfgrid/edit/stroke_file.h"

namespace sdfgrid {
namespace {

using namespace sdfgrid::test;
constexpr int kExtent = 24;

std::string read_all(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

void write_all(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

// Ten records of different lengths, as bytes.
std::string small_journal(const Folder& folder, std::vector<std::string>& texts) {
  const std::string path = folder.path("journal");
  texts = {"session 1 local"};
  create_journal(path, texts[0]);
  Journal journal(path, read_journal(path));
  for (int i = 1; i < 10; ++i) {
    texts.push_back("stroke " + std::string(static_cast<std::size_t>(3 * i), char('a' + i)));
    journal.append(texts.back());
  }
  return read_all(path);
}

// Whatever is wrong with a journal, no record is taken for good that was not written.
void expect_prefix(const JournalContent& content, const std::vector<std::string>& texts) {
  ASSERT_LE(content.records.size(), texts.size());
  for (std::size_t i = 0; i < content.records.size(); ++i) {
    ASSERT_EQ(content.records[i].text, texts[i]);
  }
}

TEST(Journal, ReadsWhatWasWritten) {
  const Folder folder;
  std::vector<std::string> texts;
  const JournalContent content = parse_journal(small_journal(folder, texts));
  expect_prefix(content, texts);
  EXPECT_EQ(content.records.size(), 10U);
  EXPECT_FALSE(content.torn() || content.damaged());
}

TEST(Journal, CutOffAtAnyByte) {
  const Folder folder;
  std::vector<std::string> texts;
  const std::string bytes = small_journal(folder, texts);
  for (std::size_t cut = 0; cut < bytes.size(); ++cut) {
    const JournalContent content = parse_journal(std::string_view(bytes).substr(0, cut));
    expect_prefix(content, texts);
    const auto whole = std::count(bytes.begin(), bytes.begin() + static_cast<long>(cut), '\n');
    ASSERT_EQ(content.records.size(), static_cast<std::size_t>(whole)) << cut;
    ASSERT_FALSE(content.damaged()) << cut;
    ASSERT_EQ(content.torn(), cut > 0 && bytes[cut - 1] != '\n') << cut;
    // Goes on from there as if nothing had been.
    const std::string path = folder.path("cut");
    write_all(path, bytes.substr(0, cut));
    if (content.records.empty()) continue;
    Journal(path, content).append("stroke more");
    const JournalContent after = read_journal(path);
    ASSERT_FALSE(after.torn() || after.damaged()) << cut;
    ASSERT_EQ(after.records.size(), content.records.size() + 1) << cut;
  }
}

TEST(Journal, EveryFlippedBitIsNoticed) {
  const Folder folder;
  std::vector<std::string> texts;
  const std::string bytes = small_journal(folder, texts);
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string changed = bytes;
      changed[at] = static_cast<char>(changed[at] ^ (1 << bit));
      const JournalContent content = parse_journal(changed);
      expect_prefix(content, texts);
      ASSERT_LT(content.records.size(), texts.size()) << at << " bit " << bit;
      const auto before = std::count(bytes.begin(), bytes.begin() + static_cast<long>(at), '\n');
      ASSERT_EQ(content.records.size(), static_cast<std::size_t>(before)) << at << " bit " << bit;
      ASSERT_EQ(content.damaged(), before < 9) << at << " bit " << bit;
    }
  }
}

TEST(Journal, AnyBytesAreUnderstood) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 3000; ++trial) {
    std::string bytes;
    for (auto i = random() % 200; i > 0; --i) bytes += "0123 \nabcf\x00\xff"[random() % 12];
    const JournalContent content = parse_journal(bytes);
    EXPECT_LE(content.good_bytes, bytes.size());
  }
}

Stroke stroke(std::size_t number) { return parse_stroke(stroke_text(number), "test"); }

// What the strokes 0 to count - 1 make.
Content expected_content(std::size_t count) {
  const Grid grid = ball_grid(12);
  SculptOptions options;
  options.range = Sculptor(grid).range();
  Sculptor sculptor(grid, options);
  for (std::size_t i = 0; i < count; ++i) (void)sculptor.apply(stroke(i), Job());
  return content_of(grid, kExtent);
}

TEST(Session, OpensWithWhatWasDone) {
  const Folder folder;
  const std::string path = folder.path("s");
  create_session(path, ball_grid(12), Redistance::local);
  {
    Session session(path, {}, Job());
    for (std::size_t i = 0; i < 12; ++i) (void)session.apply(stroke(i), Job());
    EXPECT_EQ(session.undo(3, Job()), 3U);
    EXPECT_EQ(session.redo(1, Job()), 1U);
  }
  Session session(path, {}, Job());
  EXPECT_EQ(session.strokes().size(), 10U);
  EXPECT_EQ(session.undone().size(), 2U);
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(10));
  EXPECT_EQ(session.redo(5, Job()), 2U);
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(12));
  EXPECT_EQ(session.undo(100, Job()), 12U);
  EXPECT_EQ(content_of(session.grid(), kExtent), content_of(ball_grid(12), kExtent));
  EXPECT_TRUE(session.warnings().empty());
}

TEST(Session, UsesSnapshotsWhereTheirStrokesStand) {
  const Folder folder;
  const std::string path = folder.path("s");
  create_session(path, ball_grid(12), Redistance::local);
  {
    Session session(path, {.snapshot_every = 4}, Job());
    for (std::size_t i = 0; i < 9; ++i) (void)session.apply(stroke(i), Job());
  }
  EXPECT_TRUE(std::filesystem::exists(path + "/snapshot-5.vdb"));
  EXPECT_TRUE(std::filesystem::exists(path + "/snapshot-9.vdb"));
  {
    Session session(path, {}, Job());
    EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(9));
    EXPECT_EQ(session.undo(6, Job()), 6U);  // behind both snapshots
    EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(3));
  }
  // A snapshot that cannot be read does no harm.
  write_all(path + "/snapshot-9.vdb", "nonsense");
  Session session(path, {}, Job());
  EXPECT_EQ(session.redo(6, Job()), 6U);
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(9));
}

TEST(SpillFile, GivesBackWhatItWasGivenAndReusesItsRoom) {
  const Folder folder;
  SpillFile file(folder.path(""));
  std::mt19937 random(7);
  std::map<std::size_t, std::vector<std::byte>> kept;
  std::uint64_t bytes = 0;
  std::uint64_t most = 0;
  for (int step = 0; step < 3000; ++step) {
    if (kept.empty() || random() % 2 == 0) {
      std::vector<std::byte> some(random() % 2000 + 1);
      for (std::byte& b : some) b = static_cast<std::byte>(random());
      const std::size_t name = file.put(some);
      ASSERT_FALSE(kept.contains(name));
      bytes += some.size();
      kept[name] = some;
    } else {
      const auto one = std::next(kept.begin(), static_cast<long>(random() % kept.size()));
      ASSERT_EQ(file.get(one->first), one->second);
      file.forget(one->first);
      bytes -= one->second.size();
      kept.erase(one);
    }
    most = std::max(most, bytes);
    ASSERT_LE(file.bytes(), 2 * most + 4000) << step;
  }
  EXPECT_TRUE(folder.files().empty());  // it has no name, so nothing is left after a crash
  for (const auto& [name, some] : kept) file.forget(name);
  EXPECT_EQ(file.bytes(), 0U);
}

TEST(Session, UndoRecordsBeyondTheBudgetGoToTheDisk) {
  const Folder folder;
  const std::string path = folder.path("s");
  create_session(path, ball_grid(12), Redistance::local);
  SessionOptions options;
  options.undo.full_bytes = 60000;
  options.undo.packed_bytes = 20000;
  Session session(path, options, Job());
  for (std::size_t i = 0; i < 40; ++i) (void)session.apply(stroke(i), Job());
  EXPECT_EQ(session.history().undoable(), 40U);  // none is forgotten
  EXPECT_LT(session.history().bytes(), 200000U);
  EXPECT_EQ(session.undo(33, Job()), 33U);
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(7));
  EXPECT_EQ(session.redo(20, Job()), 20U);
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(27));
  EXPECT_EQ(session.history().redoable(), 13U);
}

TEST(Session, ASecondProcessIsRefused) {
  const Folder folder;
  const std::string path = folder.path("s");
  create_session(path, ball_grid(12), Redistance::local);
  const Session session(path, {}, Job());
  // flock() belongs to the open file, so a second opening here is what another process would do.
  try {
    const Session second(path, {}, Job());
    FAIL() << "opened twice";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::failed);
    EXPECT_NE(std::string(e.what()).find(std::to_string(::getpid())), std::string::npos);
  }
  EXPECT_THROW(create_session(path, ball_grid(12), Redistance::local), Error);
}

TEST(Session, DamageNamesTheRecordAndIsSalvaged) {
  const Folder folder;
  const std::string path = folder.path("s");
  create_session(path, ball_grid(12), Redistance::local);
  {
    Session session(path, {}, Job());
    for (std::size_t i = 0; i < 6; ++i) (void)session.apply(stroke(i), Job());
  }
  std::string bytes = read_all(path + "/journal");
  std::size_t at = 0;
  for (int line = 0; line < 4; ++line) at = bytes.find('\n', at) + 1;
  bytes[at + 30] ^= 1;
  write_all(path + "/journal", bytes);
  try {
    const Session session(path, {}, Job());
    FAIL() << "damage was not noticed";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::input);
    const std::string text = e.what();
    EXPECT_NE(text.find("record 4"), std::string::npos) << text;
    EXPECT_NE(text.find("the 3 records before it are good"), std::string::npos) << text;
    EXPECT_NE(text.find("the 2 after"), std::string::npos) << text;
  }
  EXPECT_EQ(read_all(path + "/journal"), bytes);
  Session session(path, {.salvage = true}, Job());
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(3));
  EXPECT_EQ(read_all(path + "/journal.damaged"), bytes);
  EXPECT_EQ(session.warnings().size(), 1U);
}

TEST(Session, AChangedBaseIsRefused) {
  const Folder folder;
  const std::string path = folder.path("s");
  create_session(path, ball_grid(12), Redistance::local);
  write_grid(ball_grid(11), path + "/base.vdb");
  EXPECT_THROW(Session(path, {}, Job()), Error);
}

// One run of session_child; what it acknowledged comes through a pipe.
class Child {
 public:
  explicit Child(std::vector<std::string> words) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    words.insert(words.begin(), SDFGRID_SESSION_CHILD);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(ends[1], STDOUT_FILENO);
      ::execv(arguments[0], arguments.data());
      ::_exit(127);
    }
    ::close(ends[1]);
    out_ = ::fdopen(ends[0], "r");
  }
  ~Child() {
    if (pid_ > 0) kill();
    std::fclose(out_);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // The next acknowledged number; -1 at the end.
  long next() {
    long number = -1;
    return std::fscanf(out_, "%ld", &number) == 1 ? number : -1;
  }
  void kill() {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }
  [[nodiscard]] pid_t id() const { return pid_; }
  int wait() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t pid_ = -1;
  std::FILE* out_ = nullptr;
};

// The binary on a session that another process holds.
TEST(SessionCrash, ASecondProcessIsRefusedUntilTheFirstEnds) {
  const Folder folder;
  const std::string path = folder.path("s");
  create_session(path, ball_grid(12), Redistance::local);
  Child child({path});
  ASSERT_GE(child.next(), 0);
  const Outcome refused = run({"sculpt", "--session", path, "--log"});
  EXPECT_EQ(refused.exit, 1) << refused.error;
  EXPECT_NE(refused.error.find(std::to_string(child.id())), std::string::npos) << refused.error;
  child.kill();
  EXPECT_EQ(run({"sculpt", "--session", path, "--log", "--quiet"}).exit, 0);
}

TEST(SessionCrash, KilledTwoHundredTimesItLosesNothing) {
  const Folder folder;
  const std::string path = folder.path("s");
  create_session(path, ball_grid(12), Redistance::local);
  std::mt19937 random(99);
  std::size_t torn = 0;
  std::size_t standing = 0;
  for (int round = 0; round < 200; ++round) {
    long acknowledged = 0;
    {
      Child child({path});
      // Some are killed while they open, most somewhere in the strokes after.
      const unsigned strokes = random() % 4;
      for (unsigned i = 0; i <= strokes; ++i) acknowledged = std::max(acknowledged, child.next());
      ::usleep(static_cast<useconds_t>(random() % 3000));
      child.kill();
      for (long more = child.next(); more >= 0; more = child.next()) acknowledged = more;
    }
    const JournalContent content = read_journal(path + "/journal");
    ASSERT_FALSE(content.damaged()) << round;
    torn += content.torn() ? 1 : 0;
    if (round % 20 != 19) continue;
    Session session(path, {}, Job());
    standing = session.strokes().size();
    ASSERT_GE(static_cast<long>(standing), acknowledged) << round;
    ASSERT_LE(static_cast<long>(standing), acknowledged + 1) << round;
    ASSERT_EQ(content_of(session.grid(), kExtent), expected_content(standing)) << round;
  }
  EXPECT_GT(standing, 200U);
  RecordProperty("torn", static_cast<int>(torn));
}

TEST(SessionCrash, AFullDiskStopsItAndLosesNothing) {
  const Folder folder;
  const std::string path = folder.path("s");
  create_session(path, ball_grid(12), Redistance::local);
  for (int round = 0; round < 5; ++round) {
    // A few hundred bytes more than the journal has: full in the middle of some record.
    const auto size = std::filesystem::file_size(path + "/journal");
    Child child({path, std::to_string(size + 200 + 37 * static_cast<unsigned>(round))});
    long acknowledged = 0;
    for (long number = child.next(); number >= 0; number = child.next()) acknowledged = number;
    EXPECT_EQ(child.wait(), 1);  // Error{failed}
    Session session(path, {}, Job());
    ASSERT_EQ(static_cast<long>(session.strokes().size()), acknowledged) << round;
    ASSERT_EQ(content_of(session.grid(), kExtent), expected_content(session.strokes().size()));
  }
}

}  // namespace
}  // namespace sdfgrid
