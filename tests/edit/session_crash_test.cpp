// Sessions of processes that are killed, or whose disk is full: what was acknowledged is there.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <random>
#include <stdexcept>

#include "app/process.h"
#include "edit/session_tools.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/journal.h"
#include "sdfgrid/edit/session.h"

namespace sdfgrid {
namespace {

using namespace sdfgrid::test;

// One run of session_child; what it acknowledged comes through a pipe.
class Child {
 public:
  explicit Child(std::vector<std::string> words) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    words.insert(words.begin(), SDFGRID_SESSION_CHILD);
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
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

// That each record is what the child does there: session_strokes.h.
void expect_records(const JournalContent& content) {
  for (std::size_t i = 1; i < content.records.size(); ++i) {
    const ChildStep step = child_step(i);
    ASSERT_EQ(content.records[i].text, step == ChildStep::undo_two   ? "undo 2"
                                       : step == ChildStep::redo_one ? "redo 1"
                                                                     : "stroke " + stroke(i).text);
  }
}

// The strokes that stand after so many records, found out in another way than the session does.
std::vector<std::size_t> standing_after(std::size_t records) {
  std::vector<std::size_t> done;
  std::size_t undone = 0;  // the next to be redone
  for (std::size_t i = 1; i < records; ++i) {
    switch (child_step(i)) {
      case ChildStep::undo_two:
        done.pop_back();
        undone = done.back();
        done.pop_back();
        break;
      case ChildStep::redo_one:
        done.push_back(undone);
        break;
      case ChildStep::stroke:
        done.push_back(i);
    }
  }
  return done;
}

void expect_content(const std::string& path, std::size_t records) {
  const Session session(path, {}, Job());
  ASSERT_EQ(session.log().size(), records);
  const std::vector<std::size_t> standing = standing_after(records);
  ASSERT_EQ(session.strokes().size(), standing.size());
  ASSERT_EQ(content_of(session.grid(), kExtent), content_after(standing));
}

// All that was acknowledged is there, and one record more at most: the one that was under way.
void expect_acknowledged(const JournalContent& content, long acknowledged) {
  ASSERT_FALSE(content.damaged());
  ASSERT_GE(std::ssize(content.records), acknowledged);
  ASSERT_LE(std::ssize(content.records), acknowledged + 1);
  expect_records(content);
}

// Runs a child until it acknowledged so many steps and some microseconds more, and kills it.
// Returns the last number that it acknowledged; `first`: the first one.
long run_and_kill(const std::string& path, std::size_t steps, std::size_t wait, long& first) {
  Child child({path});
  first = child.next();
  long last = first;
  for (std::size_t i = 1; i < steps; ++i) last = child.next();
  ::usleep(static_cast<useconds_t>(wait));
  child.kill();
  for (long more = child.next(); more >= 0; more = child.next()) last = more;
  return last;
}

TEST(SessionCrash, KilledTwoHundredTimesItLosesNothing) {
  const Folder folder;
  const std::string path = folder.path("s");
  std::mt19937 random(99);
  std::size_t torn = 0;
  long acknowledged = 0;  // of all rounds
  for (int round = 0; round < 200; ++round) {
    SCOPED_TRACE(round);
    // Some are killed while they open, most somewhere in the strokes after.
    const auto steps = 1 + random() % 4 + (round == 0 ? 2 : 0);
    const long before = acknowledged;
    long first = -1;
    acknowledged = run_and_kill(path, steps, random() % 3000, first);
    ASSERT_GE(first, before);  // what it finds when it opens the session
    const JournalContent content = read_journal(path + "/journal");
    ASSERT_NO_FATAL_FAILURE(expect_acknowledged(content, acknowledged));
    torn += content.torn() ? 1 : 0;
    if (round % 20 != 19) continue;
    ASSERT_NO_FATAL_FAILURE(expect_content(path, content.records.size()));
  }
  EXPECT_GT(acknowledged, 200);
  RecordProperty("torn", static_cast<int>(torn));
}

TEST(SessionCrash, KilledWhileItIsMadeItIsMadeAgain) {
  const Folder folder;
  std::mt19937 random(7);
  int none = 0;
  for (int round = 0; round < 40; ++round) {
    SCOPED_TRACE(round);
    const std::string path = folder.path(std::to_string(round));
    long begin = -1;
    const long made = run_and_kill(path, 1, random() % 15000, begin);
    ASSERT_EQ(begin, 0);
    if (std::filesystem::exists(path + "/journal")) {
      // Made, but not yet opened, it has one record more than was acknowledged.
      ASSERT_NO_FATAL_FAILURE(expect_acknowledged(read_journal(path + "/journal"), made));
    } else {
      ASSERT_EQ(made, 0);
      ++none;
    }
    const long last = run_and_kill(path, 3, random() % 1000, begin);
    ASSERT_GE(begin, made);
    ASSERT_GT(last, made);
    const JournalContent content = read_journal(path + "/journal");
    ASSERT_NO_FATAL_FAILURE(expect_acknowledged(content, last));
    if (round % 10 == 9) {
      ASSERT_NO_FATAL_FAILURE(expect_content(path, content.records.size()));
    }
  }
  RecordProperty("killed before there was one", none);
}

TEST(SessionCrash, AFullDiskStopsItAndLosesNothing) {
  const Folder folder;
  const std::string path = folder.path("s");
  create_session(path, ball_grid(12), Redistance::local);
  for (int round = 0; round < 5; ++round) {
    SCOPED_TRACE(round);
    // A few hundred bytes more than the journal has: full in the middle of some record.
    const auto size = std::filesystem::file_size(path + "/journal");
    Child child({path, std::to_string(size + 200 + 37 * static_cast<unsigned>(round))});
    long acknowledged = 0;
    for (long number = child.next(); number >= 0; number = child.next()) acknowledged = number;
    EXPECT_EQ(child.wait(), 1);  // Error{failed}
    const JournalContent content = read_journal(path + "/journal");
    ASSERT_EQ(std::ssize(content.records), acknowledged);
    ASSERT_NO_FATAL_FAILURE(expect_records(content));
    ASSERT_NO_FATAL_FAILURE(expect_content(path, content.records.size()));
  }
}

}  // namespace
}  // namespace sdfgrid
