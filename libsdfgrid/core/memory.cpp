#include "sdfgrid/core/memory.h"

#include <fmt/format.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <string>

#include "sdfgrid/core/error.h"

namespace sdfgrid {
namespace {

// The bytes that a line of a file in /proc gives in kB, or -1.
double bytes_of(const char* file, const std::string& line) {
  std::ifstream info(file);
  std::string word;
  while (info >> word) {
    double kilobytes = 0;
    if (word == line && info >> kilobytes) return 1024 * kilobytes;
  }
  return -1;
}

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

double machine_memory() {
  const double available = bytes_of("/proc/meminfo", "MemAvailable:");
  if (available >= 0) return available;
  return static_cast<double>(::sysconf(_SC_PHYS_PAGES)) *
         static_cast<double>(::sysconf(_SC_PAGESIZE));
}

// The number that a file begins with; `otherwise` if there is none, as in "max".
double number_in(const std::filesystem::path& file, double otherwise) {
  std::ifstream in(file);
  double number = 0;
  return in >> number ? number : otherwise;
}

// What a control group of version 2 takes, less what of it is page cache that can be given back.
double taken_by(const std::filesystem::path& group) {
  double cache = 0;
  std::ifstream stat(group / "memory.stat");
  double bytes = 0;
  for (std::string word; stat >> word >> bytes;) {
    if (word == "active_file" || word == "inactive_file") cache += bytes;
  }
  return std::max(number_in(group / "memory.current", 0) - cache, 0.0);
}

// What the program's control groups (version 2) leave: its own and those around it.
double group_memory() {
  std::ifstream groups("/proc/self/cgroup");
  double least = kUnlimited;
  for (std::string line; std::getline(groups, line);) {
    if (!line.starts_with("0::/")) continue;
    const std::filesystem::path root = "/sys/fs/cgroup";
    std::filesystem::path group = (root / line.substr(4)).lexically_normal();
    for (; group.string().size() >= root.string().size(); group = group.parent_path()) {
      const double limit = number_in(group / "memory.max", kUnlimited);
      least = std::min(least, limit - taken_by(group));
    }
  }
  return std::max(least, 0.0);
}

double address_space() {
  ::rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnlimited;
  const double used = bytes_of("/proc/self/status", "VmSize:");
  return std::max(static_cast<double>(limit.rlim_cur) - used, 0.0);
}

}  // namespace

double available_memory() { return std::min({machine_memory(), group_memory(), address_space()}); }

void check_fits(double bytes, const std::string& what, const std::string& remedy) {
  const double available = available_memory();
  if (bytes <= available) return;
  throw Error(ErrorKind::failed,
              fmt::format("{} takes about {:.1f} GB of memory, {:.1f} GB are free; {}", what,
                          1e-9 * bytes, 1e-9 * available, remedy));
}

double allowed_memory(std::size_t max_memory) {
  constexpr double kShare = 0.8;
  return max_memory > 0 ? static_cast<double>(max_memory) : kShare * available_memory();
}

void check_allowed(double bytes, std::size_t max_memory, const std::string& what,
                   const std::string& remedy) {
  const double allowed = allowed_memory(max_memory);
  if (bytes <= allowed) return;
  throw Error(ErrorKind::failed,
              fmt::format("{} would take about {:.0f} MB, {:.0f} MB are allowed; {}, or a higher "
                          "--max-memory",
                          what, 1e-6 * bytes, 1e-6 * allowed, remedy));
}

void prefer_large_pages(void* begin, std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  void* first = begin;
  if (std::align(page, page, first, bytes) == nullptr) return;
  ::madvise(first, bytes / page * page, MADV_HUGEPAGE);  // may fail: then pages stay small
#else
  static_cast<void>(begin);
  static_cast<void>(bytes);
#endif
}

PeakMemory::PeakMemory() {
  ::malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";  // forgets the peak
  before_ = bytes_of("/proc/self/status", "VmRSS:");
}

double PeakMemory::bytes() const {
  return std::max(0.0, bytes_of("/proc/self/status", "VmHWM:") - before_);
}

}  // namespace sdfgrid
