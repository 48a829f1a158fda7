// Undo and redo of sessions that are cancelled, cannot be recorded, or whose undo records are lost.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <functional>

#include "app/process.h"
#include "edit/session_tools.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/session.h"

namespace sdfgrid {
namespace {

using namespace sdfgrid::test;
namespace fs = std::filesystem;

class SessionUndo : public ::testing::Test {
 protected:
  void make(std::size_t strokes, const SessionOptions& options = {}) {
    make_session(path_, strokes, options);
  }
  static void expect_in(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << "no '" << part << "' in: " << text;
  }

  Folder folder_;
  std::string path_ = folder_.path("s");
  std::string journal_ = path_ + "/journal";
  const SessionOptions reading_{.read_only = true};
};

// While strokes are replayed undo and redo may be cancelled, or fail to be recorded: the session
// goes on as if they had not been asked for.
TEST_F(SessionUndo, UndoAndRedoThatFailChangeNothing) {
  make(6, {.snapshot_every = 6});
  Session session(path_, {}, Job());  // from the snapshot: none of the strokes is in its memory
  const auto expect_unchanged = [&](std::size_t strokes) {
    EXPECT_EQ(session.strokes().size(), strokes);
    EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(strokes));
    const Session again(path_ + "-copy", reading_, Job());
    EXPECT_EQ(content_of(again.grid(), kExtent), expected_content(strokes));
  };
  const auto copy = [&] {
    fs::remove_all(path_ + "-copy");
    fs::copy(path_, path_ + "-copy", fs::copy_options::recursive);
    fs::remove(path_ + "-copy/lock");
  };
  const Job cancelled;
  cancelled.cancel();
  EXPECT_THROW((void)session.undo(4, cancelled), Error);
  copy();
  expect_unchanged(6);
  {
    const FileSizeLimit full(fs::file_size(journal_));
    EXPECT_THROW((void)session.undo(4, Job()), Error);
  }
  copy();
  expect_unchanged(6);
  EXPECT_EQ(session.undo(4, Job()), 4U);
  copy();
  expect_unchanged(2);
  EXPECT_THROW((void)session.redo(3, cancelled), Error);
  copy();
  expect_unchanged(2);
  {
    const FileSizeLimit full(fs::file_size(journal_));
    EXPECT_THROW((void)session.redo(3, Job()), Error);
  }
  copy();
  expect_unchanged(2);
  EXPECT_EQ(session.redo(4, Job()), 4U);
  copy();
  expect_unchanged(6);
}

// Makes the file without a name in a folder, of undo records, one that cannot be read.
void lose_spilled_records(const std::string& folder) {
  for (const auto& entry : fs::directory_iterator("/proc/self/fd")) {
    std::error_code none;
    const std::string target = fs::read_symlink(entry.path(), none).string();
    if (!target.starts_with(folder + "/") || !target.ends_with(" (deleted)")) continue;
    const int unread = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    ASSERT_GE(::dup2(unread, std::stoi(entry.path().filename().string())), 0);
    ::close(unread);
  }
}

const SessionOptions kSpills{.undo = {.full_bytes = 1, .packed_bytes = 0}};

// Its record is on the disk before, so it stands.
TEST_F(SessionUndo, AnUndoWhoseRecordsAreLostIsDoneByReplay) {
  make(0);
  Session session(path_, kSpills, Job());
  for (std::size_t i = 0; i < 6; ++i) (void)session.apply(stroke(i), Job());
  lose_spilled_records(path_);
  EXPECT_EQ(session.undo(4, Job()), 4U);
  ASSERT_EQ(session.warnings().size(), 1U);
  expect_in(session.warnings()[0], "undo records cannot be read");
  EXPECT_EQ(session.strokes().size(), 2U);
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(2));
  EXPECT_EQ(session.redo(4, Job()), 4U);
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(6));
}

TEST_F(SessionUndo, WithoutItsGridASessionGoesNoFurther) {
  make(0);
  {
    Session session(path_, kSpills, Job());
    for (std::size_t i = 0; i < 6; ++i) (void)session.apply(stroke(i), Job());
    lose_spilled_records(path_);
    fs::rename(path_ + "/base.vdb", path_ + "/away");  // nothing to replay from
    const auto problem = [](const std::function<void()>& call) -> std::string {
      try {
        call();
      } catch (const Error& e) {
        return e.what();
      }
      return "nothing";
    };
    expect_in(problem([&] { (void)session.undo(4, Job()); }), "undo records cannot be read");
    for (const auto& call : {std::function<void()>([&] { (void)session.apply(stroke(9), Job()); }),
                             std::function<void()>([&] { (void)session.undo(1, Job()); }),
                             std::function<void()>([&] { (void)session.redo(1, Job()); }),
                             std::function<void()>([&] { (void)session.grid(); }),
                             std::function<void()>([&] { (void)session.history(); })}) {
      expect_in(problem(call), "open the session again");
    }
    fs::rename(path_ + "/away", path_ + "/base.vdb");
  }
  const Session session(path_, {}, Job());
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(2));
}

// Strokes that were redone before it are undone again, which is quicker than to replay all others.
TEST_F(SessionUndo, ARedoThatIsCancelledReplaysNothing) {
  make(6, {.snapshot_every = 6});  // so that the session holds none of its strokes
  Session session(path_, {}, Job());
  EXPECT_EQ(session.undo(4, Job()), 4U);
  EXPECT_EQ(session.redo(2, Job()), 2U);
  EXPECT_EQ(session.undo(2, Job()), 2U);  // two of the four are in memory
  fs::rename(path_ + "/base.vdb", path_ + "/away");
  const Job cancelled;
  cancelled.cancel();
  EXPECT_THROW((void)session.redo(4, cancelled), Error);
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(2));
  {
    const FileSizeLimit full(fs::file_size(journal_));
    EXPECT_THROW((void)session.redo(4, Job()), Error);
  }
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(2));
  EXPECT_EQ(session.undone().size(), 4U);
  EXPECT_EQ(session.redo(4, Job()), 4U);
  EXPECT_EQ(content_of(session.grid(), kExtent), expected_content(6));
  fs::rename(path_ + "/away", path_ + "/base.vdb");
}

}  // namespace
}  // namespace sdfgrid
