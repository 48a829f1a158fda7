#include "sdfgrid/core/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <set>
#include <vector>

#include "sdfgrid/core/error.h"

namespace sdfgrid {
namespace {

// Forces the file's bytes to disk, and reports a disk that was full only when they got there.
void flush_to_disk(const std::string& path, const std::string& shown) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool ok = file >= 0 && ::fsync(file) == 0;
  const int reason = errno;
  if (file >= 0) ::close(file);
  if (!ok) {
    throw Error(ErrorKind::failed, shown + ": cannot be written (" + std::strerror(reason) + ")");
  }
}

// The names in a folder, too; file systems that cannot flush a folder write them with the files.
void flush_names(const std::filesystem::path& folder) {
  const int names = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (names < 0) return;
  (void)::fsync(names);
  ::close(names);
}

// The temporaries that exist now or are about to.
struct Registry {
  std::mutex mutex;
  std::set<std::filesystem::path> files;
};

Registry& registry() {
  static Registry instance;
  return instance;
}

// Holds a name in the registry while it lives.
class Registered {
 public:
  explicit Registered(const std::filesystem::path& file) : file_(file) {
    const std::lock_guard lock(registry().mutex);
    registry().files.insert(file);
  }
  ~Registered() {
    const std::lock_guard lock(registry().mutex);
    registry().files.erase(file_);
  }
  Registered(const Registered&) = delete;
  Registered& operator=(const Registered&) = delete;

 private:
  std::filesystem::path file_;
};

void write_bytes(const std::string& file, const std::string& shown,
                 std::span<const std::byte> bytes) {
  errno = 0;
  std::FILE* out = std::fopen(file.c_str(), "wb");
  bool ok = out != nullptr && std::fwrite(bytes.data(), 1, bytes.size(), out) == bytes.size();
  if (out != nullptr) ok = std::fclose(out) == 0 && ok;
  if (!ok) {
    throw Error(ErrorKind::failed, shown + ": cannot be written (" + std::strerror(errno) + ")");
  }
}

}  // namespace

void remove_temporaries() noexcept {
  const std::lock_guard lock(registry().mutex);
  std::error_code ignored;
  for (const auto& file : registry().files) std::filesystem::remove(file, ignored);
}

std::string follow_links(const std::string& path) {
  namespace fs = std::filesystem;
  constexpr int kMostLinks = 40;  // as Linux has it
  fs::path at(path);
  std::error_code none;
  for (int i = 0; i < kMostLinks; ++i) {
    if (!fs::is_symlink(fs::symlink_status(at, none))) return at.string();
    at = at.parent_path() / fs::read_symlink(at);
  }
  throw Error(ErrorKind::failed, path + ": the link leads to itself");
}

void create_folders(const std::string& path) {
  namespace fs = std::filesystem;
  std::vector<fs::path> missing;  // the innermost first
  std::error_code none;
  fs::path at = fs::absolute(path).lexically_normal();
  if (!at.has_filename()) at = at.parent_path();  // of a path that ends in '/'
  for (; !fs::exists(at, none) && at != at.parent_path(); at = at.parent_path()) {
    missing.push_back(at);
  }
  std::error_code failed;
  fs::create_directories(path, failed);
  if (failed) throw Error(ErrorKind::failed, path + ": " + failed.message());
  for (const fs::path& folder : missing) flush_names(folder.parent_path());
}

void write_atomically(const std::string& path,
                      const std::function<void(const std::string& temporary)>& write) {
  namespace fs = std::filesystem;
  const fs::path target(follow_links(path));
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (!fs::is_directory(folder)) {
    throw Error(ErrorKind::failed, folder.string() + ": no such folder; create it first");
  }
  const fs::path temporary = folder / ("." + target.stem().string() + ".partial-" +
                                       std::to_string(::getpid()) + target.extension().string());
  const Registered registered(temporary);
  std::error_code ignored;
  try {
    write(temporary.string());
    flush_to_disk(temporary.string(), path);
    const fs::file_status before = fs::status(target, ignored);
    if (fs::exists(before)) fs::permissions(temporary, before.permissions(), ignored);
    std::error_code failed;
    fs::rename(temporary, target, failed);
    if (failed) throw Error(ErrorKind::failed, path + ": " + failed.message());
    flush_names(folder);
  } catch (...) {
    fs::remove(temporary, ignored);
    throw;
  }
}

void write_bytes_atomically(const std::string& path, std::span<const std::byte> bytes) {
  write_atomically(path,
                   [&](const std::string& temporary) { write_bytes(temporary, path, bytes); });
}

}  // namespace sdfgrid
