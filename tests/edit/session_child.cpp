// A process to be killed: opens the session in the folder it is given and applies strokes without
// end, printing the number of strokes that stand after each that was acknowledged.
//
//   session_child DIR [MOST_BYTES]      a file may not grow beyond MOST_BYTES, as on a full disk
#include <sys/resource.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "edit/session_strokes.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/session.h"
#include "sdfgrid/edit/stroke_file.h"

int main(int count, char** words) {
  using namespace sdfgrid;
  if (count < 2) return 2;
  if (count > 2) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlim_t most = std::strtoul(words[2], nullptr, 10);
    const rlimit limit{most, most};
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0) return 2;
  }
  try {
    SessionOptions options;
    options.snapshot_every = 7;
    Session session(words[1], options, Job());
    std::printf("%zu\n", session.strokes().size());
    std::fflush(stdout);
    for (;;) {
      const std::size_t number = session.strokes().size();
      (void)session.apply(parse_stroke(test::stroke_text(number), "test"), Job());
      std::printf("%zu\n", session.strokes().size());
      std::fflush(stdout);
    }
  } catch (const Error& e) {
    std::fputs(e.what(), stderr);
    return e.kind() == ErrorKind::failed ? 1 : 4;
  }
}
