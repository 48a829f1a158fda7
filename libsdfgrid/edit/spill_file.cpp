#include "sdfgrid/edit/spill_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <iterator>

#include "sdfgrid/core/error.h"

namespace sdfgrid {
namespace {

[[noreturn]] void fail(const std::string& folder, const char* what) {
  throw Error(ErrorKind::failed, fmt::format("{}: undo records cannot be {} ({})", folder, what,
                                             errno != 0 ? std::strerror(errno) : "cut off"));
}

// Calls step(offset done) until all is done; it returns how much it did.
template <class Step>
bool repeat(std::size_t size, const Step& step) {
  errno = 0;
  for (std::size_t done = 0; done < size;) {
    const ssize_t n = step(done);
    if (n > 0) done += static_cast<std::size_t>(n);
    if (n == 0 || (n < 0 && errno != EINTR)) return false;
  }
  return true;
}

}  // namespace

SpillFile::~SpillFile() {
  if (file_ >= 0) ::close(file_);
}

void SpillFile::open() {
  if (file_ >= 0) return;
  file_ = ::open(folder_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file_ >= 0) return;
  // Not every file system has files without a name.
  std::string name = folder_ + "/undo-XXXXXX";
  file_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (file_ < 0) fail(folder_, "kept");
  ::unlink(name.c_str());
}

// The first gap that is large enough, or the end.
std::uint64_t SpillFile::find_place(std::uint64_t size) {
  const auto gap =
      std::find_if(free_.begin(), free_.end(), [&](const auto& g) { return g.second >= size; });
  if (gap == free_.end()) return end_;
  const std::uint64_t at = gap->first;
  if (gap->second > size) free_[at + size] = gap->second - size;
  free_.erase(at);
  return at;
}

std::size_t SpillFile::put(std::span<const std::byte> bytes) {
  open();
  const std::uint64_t at = find_place(bytes.size());
  const std::uint64_t end = std::max<std::uint64_t>(end_, at + bytes.size());
  used_[at] = bytes.size();
  const bool written = repeat(bytes.size(), [&](std::size_t done) {
    return ::pwrite(file_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(at + done));
  });
  end_ = end;
  if (!written) {
    const int reason = errno;
    forget(at);
    errno = reason;
    fail(folder_, "kept");
  }
  return at;
}

std::vector<std::byte> SpillFile::get(std::size_t name) {
  std::vector<std::byte> bytes(used_.at(name));
  const bool read = repeat(bytes.size(), [&](std::size_t done) {
    return ::pread(file_, bytes.data() + done, bytes.size() - done,
                   static_cast<off_t>(name + done));
  });
  if (!read) fail(folder_, "read");
  return bytes;
}

void SpillFile::forget(std::size_t name) {
  const auto used = used_.find(name);
  if (used == used_.end()) return;
  auto gap = free_.emplace(name, used->second).first;
  used_.erase(used);
  const auto next = std::next(gap);
  if (next != free_.end() && gap->first + gap->second == next->first) {
    gap->second += next->second;
    free_.erase(next);
  }
  if (gap != free_.begin()) {
    const auto last = std::prev(gap);
    if (last->first + last->second == gap->first) {
      last->second += gap->second;
      free_.erase(gap);
      gap = last;
    }
  }
  if (gap->first + gap->second != end_) return;
  end_ = gap->first;
  free_.erase(gap);
  (void)!::ftruncate(file_, static_cast<off_t>(end_));
}

}  // namespace sdfgrid
