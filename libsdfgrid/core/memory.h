// core/memory.h: how much memory the machine has left, and how much the program takes.
#pragma once

namespace sdfgrid {

// Bytes that the machine can still hand out, the page cache included.
[[nodiscard]] double available_memory();

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
