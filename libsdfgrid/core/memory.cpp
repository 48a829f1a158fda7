#include "sdfgrid/core/memory.h"

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <string>

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

}  // namespace

double available_memory() {
  const double available = bytes_of("/proc/meminfo", "MemAvailable:");
  if (available >= 0) return available;
  return static_cast<double>(::sysconf(_SC_PHYS_PAGES)) *
         static_cast<double>(::sysconf(_SC_PAGESIZE));
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
