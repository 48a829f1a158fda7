// Sessions whose files were damaged, torn or made by a newer version, and those that cannot write.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "app/process.h"
#include "edit/session_tools.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/journal.h"
#include "sdfgrid/edit/session.h"
#include "sdfgrid/edit/snapshots.h"

namespace sdfgrid {
namespace {

using namespace sdfgrid::test;
namespace fs = std::filesystem;

// A session of so many strokes.
class SessionDamage : public ::testing::Test {
 protected:
  void make(std::size_t strokes, const SessionOptions& options = {}) {
    make_session(path_, strokes, options);
  }
  // Where a record begins in the journal.
  static std::size_t place_of(const std::string& bytes, std::size_t record) {
    std::size_t at = 0;
    for (std::size_t i = 0; i < record; ++i) at = bytes.find('\n', at) + 1;
    return at;
  }
  // Changes a bit of a record, counted from its beginning or, below 0, from the end of the file.
  std::string flip(std::size_t record, std::ptrdiff_t offset) {
    std::string bytes = read_all(journal_);
    const std::size_t from = offset < 0 ? bytes.size() : place_of(bytes, record);
    bytes[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(from) + offset)] ^= 1;
    write_all(journal_, bytes);
    return bytes;
  }
  // What opening says, which is refused as a bad input and changes no byte of the journal.
  std::string refusal(const SessionOptions& options) {
    const std::string before = read_all(journal_);
    std::string text = "nothing";
    try {
      const Session session(path_, options, Job());
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::input) << e.what();
      text = e.what();
    } catch (const std::exception& e) {
      text = std::string("raw: ") + e.what();
    }
    EXPECT_EQ(read_all(journal_), before) << text;
    return text;
  }
  static void expect_in(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << "no '" << part << "' in: " << text;
  }

  Folder folder_;
  std::string path_ = folder_.path("s");
  std::string journal_ = path_ + "/journal";
  const SessionOptions reading_{.read_only = true};
  const SessionOptions salvage_{.salvage = true};
};

TEST_F(SessionDamage, NamesTheRecordAndIsSalvaged) {
  make(6);
  const std::string bytes = flip(4, 30);
  for (const SessionOptions& options : {SessionOptions{}, reading_}) {
    const std::string text = refusal(options);
    expect_in(text, "record 4");
    expect_in(text, "the 3 records before it are good");
    expect_in(text, "the 2 after it");
  }
  Session session(path_, salvage_, Job());
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(3));
  EXPECT_EQ(read_all(path_ + "/journal.damaged"), bytes);
  EXPECT_EQ(session.warnings().size(), 1U);
}

// It was written to its end, so it was acknowledged: no torn one, which may be cut off.
TEST_F(SessionDamage, OfTheLastRecordIsNoTornRecord) {
  make(6);
  for (const std::ptrdiff_t place : {-20, -1}) {  // its text, its line break
    flip(6, place);
    for (const SessionOptions& options : {SessionOptions{}, reading_}) {
      const std::string text = refusal(options);
      expect_in(text, "record 6");
      expect_in(text, "the 5 records before it are good, there is none after it");
      expect_in(text, "--salvage");
    }
    if (place == -20) flip(6, place);
  }
  Session session(path_, salvage_, Job());
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(5));
}

TEST_F(SessionDamage, OfTheFirstRecordSaysWhatCanBeRead) {
  make(6);
  flip(0, 30);
  for (const SessionOptions& options : {SessionOptions{}, reading_, salvage_}) {
    const std::string text = refusal(options);
    expect_in(text, "record 0");
    expect_in(text, "the 6 records after it can be read");
    expect_in(text, "base.vdb");
  }
  write_all(journal_, "");
  expect_in(refusal(salvage_), "no other record can be read");
}

TEST_F(SessionDamage, EachSalvageKeepsItsJournal) {
  make(6);
  const std::string first = flip(5, 30);
  { const Session session(path_, salvage_, Job()); }
  const std::string second = flip(3, 30);
  { const Session session(path_, salvage_, Job()); }
  EXPECT_EQ(read_all(path_ + "/journal.damaged"), first);
  EXPECT_EQ(read_all(path_ + "/journal.damaged-2"), second);
}

TEST_F(SessionDamage, ATornRecordIsCutOffByWhoWritesAndKept) {
  make(6);
  for (const char* kept : {"/journal.torn", "/journal.torn-2"}) {
    const std::string whole = read_all(journal_);
    const std::size_t last = whole.rfind('\n', whole.size() - 2) + 1;
    const std::string torn = whole.substr(0, whole.size() - 10);
    write_all(journal_, torn);
    {
      const Session session(path_, reading_, Job());
      ASSERT_EQ(session.warnings().size(), 1U);
      expect_in(session.warnings()[0], "not complete");
      EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(5));
    }
    EXPECT_EQ(read_all(journal_), torn);
    Session session(path_, {}, Job());
    ASSERT_EQ(session.warnings().size(), 1U);
    expect_in(session.warnings()[0], std::string(kept).substr(1));
    EXPECT_EQ(read_all(path_ + kept), torn.substr(last));
    EXPECT_EQ(read_all(journal_), whole.substr(0, last));
    (void)session.apply(stroke(5), Job());
    EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(6));
  }
}

// Hashes are right, so these were written on purpose: what they did must not be left out.
TEST_F(SessionDamage, ARecordOfANewerVersionIsRefused) {
  make(2);
  const std::string good = read_all(journal_);
  const std::string rest = "brush: {sphere: {radius: 0.3}}, path: [[1.2, 0, 0]]";
  for (const std::string& text :
       {std::string("carve 3"), std::string("undo"), std::string("undo x"), std::string("undo 1 2"),
        std::string("redo 99999999999999999999"), std::string("und"), std::string("x"),
        "stroke {op: union, " + rest + ", colour: red}", "stroke {op: gouge, " + rest + "}"}) {
    write_all(journal_, good);
    Journal(journal_, read_journal(journal_)).append(text);
    for (const SessionOptions& options : {SessionOptions{}, reading_, salvage_}) {
      const std::string said = refusal(options);
      expect_in(said, "record 3");
      expect_in(said, "newer version");
    }
  }
  fs::remove(journal_);
  create_journal(journal_, "session 2 local");
  expect_in(refusal({}), "newer version");
}

TEST_F(SessionDamage, AStrokeThatWouldNotBeReadAgainIsNotRecorded) {
  make(1);
  Session session(path_, {}, Job());
  std::string text = stroke_text(1);
  text.insert(text.size() - 1, ", colour: red");
  EXPECT_THROW((void)session.apply(parse_stroke(text, "test"), Job()), Error);
  EXPECT_EQ(session.log().size(), 2U);
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(1));
}

// Words that are known are recorded where they do nothing, too.
TEST_F(SessionDamage, AWordThatDoesNothingIsRecorded) {
  make(1);
  std::string text = stroke_text(1);
  text.insert(text.size() - 1, ", strength: 0.5, name: a bump");
  {
    Session session(path_, {}, Job());
    (void)session.apply(parse_stroke(text, "test"), Job());
  }
  const Session session(path_, {}, Job());
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(2));
}

TEST_F(SessionDamage, AStrokeThatCouldNotBeRecordedLeavesRedoAsItWas) {
  make(3);
  Session session(path_, {}, Job());
  (void)session.apply(stroke(3), Job());
  (void)session.apply(stroke(4), Job());
  EXPECT_EQ(session.undo(3, Job()), 3U);  // two of this opening, one of the one before
  const std::vector<std::string> undone = session.undone();
  {
    const FileSizeLimit full(fs::file_size(journal_) + 20);
    EXPECT_THROW((void)session.apply(stroke(9), Job()), Error);
  }
  EXPECT_EQ(session.undone(), undone);
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(2));
  EXPECT_EQ(session.redo(1, Job()), 1U);
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(3));
  EXPECT_EQ(session.redo(5, Job()), 2U);
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(5));
  // The last stroke is kept for this whatever the budget.
  SessionOptions none;
  none.undo.full_bytes = 0;
  none.undo.packed_bytes = 0;
  fs::copy(path_, folder_.path("copy"));
  Session other(folder_.path("copy"), none, Job());
  {
    const FileSizeLimit full(fs::file_size(folder_.path("copy/journal")) + 20);
    EXPECT_THROW((void)other.apply(stroke(9), Job()), Error);
  }
  EXPECT_EQ(content_of(other.grid(), kExtent), expected_content(5));
}

TEST_F(SessionDamage, ASnapshotThatFailsLeavesNoTrace) {
  make(3);
  Session session(path_, {.snapshot_every = 1}, Job());
  const auto before = session.grid().all_metadata();
  const auto size = fs::file_size(journal_);
  {
    const FileSizeLimit full(size + 300);
    ASSERT_LT(size + 300, fs::file_size(path_ + "/base.vdb"));
    (void)session.apply(stroke(3), Job());
  }
  ASSERT_EQ(session.warnings().size(), 1U);
  expect_in(session.warnings()[0], "no snapshot was made");
  EXPECT_EQ(session.grid().all_metadata(), before);
  EXPECT_TRUE(find_snapshots(path_).empty());
}

TEST_F(SessionDamage, AChangedSnapshotIsNoticed) {
  make(7, {.snapshot_every = 6});
  const std::vector<Snapshot> made = find_snapshots(path_);
  ASSERT_EQ(made.size(), 1U);
  const std::string good = read_all(made[0].path);
  const Content expected = expected_content(7);
  {
    const Session session(path_, reading_, Job());
    EXPECT_TRUE(session.warnings().empty());
    EXPECT_EQ(content_of(session.grid(), kExtent), expected);
  }
  for (std::size_t i = 0; i < 30; ++i) {
    std::string bytes = good;
    bytes[good.size() * i / 30] ^= static_cast<char>(1 << i % 8);
    write_all(made[0].path, bytes);
    const Session session(path_, reading_, Job());
    ASSERT_EQ(session.warnings().size(), 1U) << i;
    expect_in(session.warnings()[0], "snapshot-7-");
    ASSERT_EQ(content_of(session.grid(), kExtent), expected) << i;
  }
}

// With as many records as it says, but other ones.
TEST_F(SessionDamage, ASnapshotOfAnotherJournalIsPassedOver) {
  make(7, {.snapshot_every = 6});
  const std::string of_old = find_snapshots(path_).at(0).path;
  const std::string bytes = read_all(of_old);
  flip(5, 30);
  {
    Session session(path_, salvage_, Job());
    for (std::size_t i = 10; i < 13; ++i) (void)session.apply(stroke(i), Job());
  }
  write_all(of_old, bytes);
  ASSERT_EQ(find_snapshots(path_).size(), 1U);
  const Session session(path_, reading_, Job());
  EXPECT_TRUE(session.warnings().empty());
  EXPECT_EQ(content_of(session.grid(), kExtent), content_after({0, 1, 2, 3, 10, 11, 12}));
}

// Those of the journal before it had more records, but are of no use any more.
TEST_F(SessionDamage, SnapshotsAfterASalvageStay) {
  make(9, {.snapshot_every = 2});
  flip(5, 30);
  {
    SessionOptions options = salvage_;
    options.snapshot_every = 2;
    Session session(path_, options, Job());
    EXPECT_TRUE(find_snapshots(path_).empty());
    for (std::size_t i = 10; i < 12; ++i) (void)session.apply(stroke(i), Job());
  }
  const std::vector<Snapshot> made = find_snapshots(path_);
  ASSERT_FALSE(made.empty());
  EXPECT_EQ(made[0].records, 6U);  // how it began, four that were good, a new one
  const Session session(path_, reading_, Job());
  EXPECT_EQ(content_of(session.grid(), kExtent), content_after({0, 1, 2, 3, 10, 11}));
}

TEST_F(SessionDamage, LeftoversGoWhenItIsOpenedForWriting) {
  make(9, {.snapshot_every = 2});
  const std::vector<Snapshot> made = find_snapshots(path_);
  ASSERT_EQ(made.size(), 2U);  // of four
  EXPECT_EQ(made[0].records, 9U);
  EXPECT_EQ(made[1].records, 7U);
  fs::create_directory(path_ + "/stamps");
  const std::string left[] = {path_ + "/.snapshot.partial-77.vdb", path_ + "/.journal.partial-1",
                              path_ + "/stamps/.0123.partial-77.vdb"};
  for (const std::string& file : left) write_all(file, "half");
  write_all(path_ + "/stamps/0123.vdb", "kept");
  { const Session session(path_, reading_, Job()); }
  for (const std::string& file : left) EXPECT_TRUE(fs::exists(file)) << file;
  { const Session session(path_, {}, Job()); }
  for (const std::string& file : left) EXPECT_FALSE(fs::exists(file)) << file;
  EXPECT_TRUE(fs::exists(path_ + "/stamps/0123.vdb"));
  EXPECT_EQ(find_snapshots(path_).size(), 2U);
}

}  // namespace
}  // namespace sdfgrid
