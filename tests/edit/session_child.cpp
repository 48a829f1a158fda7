// A process to be killed: opens the session in the folder it is given, makes it if there is none,
// and applies, undoes and redoes strokes without end. Prints 0 when it begins to make a session and
// the number of records of the journal after each that was acknowledged.
//
//   session_child DIR [MOST_BYTES]      a file may not grow beyond MOST_BYTES, as on a full disk
#include <sys/resource.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "edit/grids.h"
#include "edit/session_strokes.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/session.h"
#include "sdfgrid/edit/stroke_file.h"

namespace {

using namespace sdfgrid;

void acknowledge(std::size_t records) {
  std::printf("%zu\n", records);
  std::fflush(stdout);
}

SessionLock make_if_missing(const std::string& folder) {
  if (std::filesystem::exists(folder + "/journal")) return {};
  acknowledge(0);
  return create_session(folder, test::ball_grid(12), Redistance::local);
}

void work(const std::string& folder) {
  SessionOptions options;
  options.snapshot_every = 7;
  Session session(folder, options, Job(), make_if_missing(folder));
  for (;;) {
    const std::size_t number = session.log().size();
    acknowledge(number);
    switch (test::child_step(number)) {
      case test::ChildStep::undo_two:
        (void)session.undo(2, Job());
        break;
      case test::ChildStep::redo_one:
        (void)session.redo(1, Job());
        break;
      case test::ChildStep::stroke:
        (void)session.apply(parse_stroke(test::stroke_text(number), "test"), Job());
    }
  }
}

}  // namespace

int main(int count, char** words) {
  if (count < 2) return 2;
  if (count > 2) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlim_t most = std::strtoul(words[2], nullptr, 10);
    const rlimit limit{most, most};
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0) return 2;
  }
  try {
    work(words[1]);
  } catch (const Error& e) {
    std::fputs(e.what(), stderr);
    return e.kind() == ErrorKind::failed ? 1 : 4;
  }
}
