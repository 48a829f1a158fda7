// core/isa.h: which build of a vector kernel this machine runs. Kernels are compiled once for each
// instruction set (see sdfgrid_kernel in cmake/Targets.cmake) and chosen here at run time.
#pragma once

#include <string_view>

namespace sdfgrid {

enum class Isa { baseline, avx2, avx512 };

// The best instruction set that this machine has and this build contains, or the one named by the
// environment variable SDFGRID_ISA (baseline, avx2, avx512) if the machine has it: for tests.
[[nodiscard]] Isa active_isa();

[[nodiscard]] std::string_view isa_name(Isa isa);

}  // namespace sdfgrid
