// Journals as bytes, sessions over many openings, undo, locks. What is damaged or cannot be written
// is in session_damage_test.cpp, crashes are in session_crash_test.cpp.
#include "sdfgrid/edit/session.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <random>
#include <utility>

#include "app/process.h"
#include "edit/session_tools.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/journal.h"
#include "sdfgrid/edit/snapshots.h"

namespace sdfgrid {
namespace {

using namespace sdfgrid::test;
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
      // The last record, too, was whole: it is no torn one.
      ASSERT_TRUE(content.damaged()) << at << " bit " << bit;
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
  make_session(path, 9, {.snapshot_every = 4});
  const std::vector<Snapshot> made = find_snapshots(path);
  ASSERT_EQ(made.size(), 2U);
  EXPECT_EQ(made[0].records, 9U);
  EXPECT_EQ(made[1].records, 5U);
  Session session(path, {}, Job());
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(9));
  EXPECT_EQ(session.undo(6, Job()), 6U);  // behind both snapshots
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(3));
  EXPECT_EQ(session.redo(6, Job()), 6U);
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(9));
  EXPECT_TRUE(session.warnings().empty());
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

// Held from before the first byte, and never let go between making and opening.
TEST(Session, MakingOneTakesTheLock) {
  const Folder folder;
  const std::string path = folder.path("s");
  std::filesystem::create_directory(path);
  {
    const SessionLock other(path, SessionLock::Use::writing);
    EXPECT_THROW(create_session(path, ball_grid(12), Redistance::local), Error);
    EXPECT_FALSE(std::filesystem::exists(path + "/base.vdb"));
  }
  SessionLock lock = create_session(path, ball_grid(12), Redistance::local);
  const std::string journal = read_all(path + "/journal");
  EXPECT_THROW(Session(path, {}, Job()), Error);
  Session session(path, {}, Job(), std::move(lock));
  EXPECT_THROW(Session(path, {}, Job()), Error);
  EXPECT_THROW(create_session(path, ball_grid(11), Redistance::local), Error);
  EXPECT_EQ(read_all(path + "/journal"), journal);
}

TEST(Session, IsMadeInNoFolderWithOtherFiles) {
  const Folder folder;
  const std::string path = folder.path("s");
  std::filesystem::create_directory(path);
  write_all(path + "/base.vdb", "somebody's own");
  EXPECT_THROW(create_session(path, ball_grid(12), Redistance::local), Error);
  EXPECT_EQ(read_all(path + "/base.vdb"), "somebody's own");
  EXPECT_FALSE(std::filesystem::exists(path + "/lock"));
  // Behind a lock it is what an interrupted creation left.
  write_all(path + "/lock", "");
  create_session(path, ball_grid(12), Redistance::local);
  EXPECT_EQ(content_of(Session(path, {}, Job()).grid(), kExtent), expected_content(0));
}

// Every file with its bytes.
std::map<std::string, std::string> bytes_in(const std::string& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    all[entry.path().filename().string()] = read_all(entry.path().string());
  }
  return all;
}

TEST(Session, OpenedForReadingItChangesNothing) {
  const Folder folder;
  const std::string path = folder.path("s");
  create_session(path, ball_grid(12), Redistance::local);
  {
    Session session(path, {.snapshot_every = 2}, Job());
    for (std::size_t i = 0; i < 5; ++i) (void)session.apply(stroke(i), Job());
    EXPECT_EQ(session.undo(1, Job()), 1U);
  }
  write_all(path + "/.snapshot.partial-1.vdb", "left");
  const auto before = bytes_in(path);
  const SessionOptions reading{.read_only = true};
  {
    Session session(path, reading, Job());
    EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(4));
    for (const auto& call : {std::function<void()>([&] { (void)session.apply(stroke(9), Job()); }),
                             std::function<void()>([&] { (void)session.undo(1, Job()); }),
                             std::function<void()>([&] { (void)session.redo(1, Job()); })}) {
      EXPECT_THROW(call(), Error);
    }
    EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(4));
    const Session another(path, reading, Job());  // readers do not disturb each other
    EXPECT_THROW(Session(path, {}, Job()), Error);
  }
  EXPECT_EQ(bytes_in(path), before);
  const Session writing(path, {}, Job());
  EXPECT_THROW(Session(path, reading, Job()), Error);
}

TEST(Session, InAFolderThatCannotBeWrittenItIsRead) {
  const Folder folder;
  const std::string path = folder.path("s");
  create_session(path, ball_grid(12), Redistance::local);
  {
    Session session(path, {}, Job());
    for (std::size_t i = 0; i < 3; ++i) (void)session.apply(stroke(i), Job());
  }
  ASSERT_EQ(::chmod(folder.path("").c_str(), 0755), 0);
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    ASSERT_EQ(::chmod(entry.path().c_str(), 0444), 0);
  }
  ASSERT_EQ(::chmod(path.c_str(), 0555), 0);
  const bool root = ::geteuid() == 0;  // whom permissions do not stop
  constexpr uid_t kNobody = 65534;
  if (root) {
    ASSERT_EQ(::seteuid(kNobody), 0);
  }
  Content content;
  std::string problem;
  try {
    content = content_of(Session(path, {.read_only = true}, Job()).grid(), kExtent);
    const Session writing(path, {}, Job());
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::failed);
    problem = e.what();
  }
  if (root) {
    ASSERT_EQ(::seteuid(0), 0);
  }
  EXPECT_EQ(content, expected_content(3));
  EXPECT_NE(problem.find("--export only read"), std::string::npos) << problem;
  ASSERT_EQ(::chmod(path.c_str(), 0755), 0);
}

TEST(Session, AChangedBaseIsRefused) {
  const Folder folder;
  const std::string path = folder.path("s");
  create_session(path, ball_grid(12), Redistance::local);
  write_grid(ball_grid(11), path + "/base.vdb");
  EXPECT_THROW(Session(path, {}, Job()), Error);
}

}  // namespace
}  // namespace sdfgrid
