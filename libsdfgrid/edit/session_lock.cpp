#include "sdfgrid/edit/session_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "sdfgrid/core/error.h"

namespace sdfgrid {
namespace {

[[noreturn]] void refuse(const std::string& folder, const std::string& problem,
                         const std::string& remedy) {
  throw Error(ErrorKind::failed, fmt::format("{}: {}; {}", folder, problem, remedy));
}

// `file`: of a lock that another process has.
[[noreturn]] void refuse_busy(const std::string& folder, int file, SessionLock::Use use) {
  const bool only_read = use == SessionLock::Use::writing && ::flock(file, LOCK_SH | LOCK_NB) == 0;
  char owner[32] = {};
  (void)!::pread(file, owner, sizeof owner - 1, 0);
  ::close(file);
  refuse(folder,
         only_read ? std::string("the session is being read by another process")
                   : fmt::format("the session is open in another process ({})", owner),
         "wait for it to end");
}

}  // namespace

SessionLock::SessionLock(const std::string& folder, Use use) {
  const bool writes = use == Use::writing;
  const std::string path = folder + "/lock";
  const int file = ::open(path.c_str(), (writes ? O_RDWR | O_CREAT : O_RDONLY) | O_CLOEXEC, 0644);
  if (file < 0) {
    const int reason = errno;
    // Who writes makes the file first: without one there is nobody to keep away from.
    if (!writes && reason == ENOENT) return;
    refuse(folder,
           fmt::format("the session cannot be {} ({})", writes ? "changed" : "read",
                       std::strerror(reason)),
           writes ? "copy it to where you may write; --log and --export only read"
                  : "ask its owner for permission");
  }
  if (::flock(file, (writes ? LOCK_EX : LOCK_SH) | LOCK_NB) != 0) refuse_busy(folder, file, use);
  file_ = file;
  if (!writes) return;
  const std::string own = fmt::format("{}", ::getpid());
  (void)!::ftruncate(file_, 0);
  (void)!::pwrite(file_, own.data(), own.size(), 0);
}

SessionLock::~SessionLock() {
  if (file_ >= 0) ::close(file_);
}

SessionLock::SessionLock(SessionLock&& other) noexcept : file_(std::exchange(other.file_, -1)) {}

SessionLock& SessionLock::operator=(SessionLock&& other) noexcept {
  std::swap(file_, other.file_);
  return *this;
}

}  // namespace sdfgrid
