// core/memory.h: how much memory the machine has left.
#pragma once

namespace sdfgrid {

// Bytes that the machine can still hand out, the page cache included.
[[nodiscard]] double available_memory();

}  // namespace sdfgrid
