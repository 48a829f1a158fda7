#include "sdfgrid/core/isa.h"

#include <cstdlib>

namespace sdfgrid {
namespace {

bool machine_has(Isa isa) {
#if defined(__x86_64__)
  switch (isa) {
    case Isa::baseline:
      return true;
    case Isa::avx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
             __builtin_cpu_supports("bmi2");
    case Isa::avx512:
      return machine_has(Isa::avx2) && __builtin_cpu_supports("avx512f") &&
             __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
             __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512cd");
  }
  return false;
#else
  return isa == Isa::baseline;
#endif
}

Isa choose() {
  Isa best = Isa::baseline;
  for (const Isa isa : {Isa::avx2, Isa::avx512}) {
    if (machine_has(isa)) best = isa;
  }
  if (const char* wanted = std::getenv("SDFGRID_ISA")) {
    for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
      if (isa_name(isa) == wanted && machine_has(isa)) return isa;
    }
  }
  return best;
}

}  // namespace

Isa active_isa() {
  static const Isa isa = choose();
  return isa;
}

std::string_view isa_name(Isa isa) {
  switch (isa) {
    case Isa::avx512:
      return "avx512";
    case Isa::avx2:
      return "avx2";
    case Isa::baseline:
      break;
  }
  return "baseline";
}

}  // namespace sdfgrid
