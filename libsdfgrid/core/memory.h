// core/memory.h: how much memory the machine has left, and how much the program takes, in pages of
// which size.
#pragma once

#include <cstddef>
#include <string>

namespace sdfgrid {

// Bytes that the program can still get, the page cache included: the least of what the machine has
// left and what its control groups (containers) and its limit of address space leave.
[[nodiscard]] double available_memory();

// Throws Error{failed} where work would take more than that, before it starts: "WHAT takes about N
// GB of memory, M GB are free; REMEDY".
void check_fits(double bytes, const std::string& what, const std::string& remedy);

// What work may take whose user may set a limit: `max_memory` bytes or, where that is 0, 80 % of
// what is available, for estimates are rough and others want some too.
[[nodiscard]] double allowed_memory(std::size_t max_memory);

// Throws Error{failed} where the work would take more than its allowed_memory, before it starts:
// "WHAT would take about N MB, M MB are allowed; REMEDY, or a higher --max-memory".
void check_allowed(double bytes, std::size_t max_memory, const std::string& what,
                   const std::string& remedy);

// Asks the system for large pages in memory that was not written to yet: for work that jumps about
// in it, as each small page is looked up by itself. Does nothing where there are none.
void prefer_large_pages(void* begin, std::size_t bytes);

// What a piece of work takes in memory: the peak of the whole program's resident memory since
// construction, less what was resident then. Memory that was freed before is given back to the
// system first, so that it is not used again unseen.
class PeakMemory {
 public:
  PeakMemory();
  [[nodiscard]] double bytes() const;  // >= 0; 0 where the system does not tell

 private:
  double before_;
};

}  // namespace sdfgrid
