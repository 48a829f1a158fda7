// core/kernel.h: how a vector kernel is declared, once for all instruction sets, and chosen at run
// time. It includes nothing, since kernels themselves include it (docs/architecture.md).
//
// SDFGRID_DECLARE_ISAS(declaration) declares something of a kernel in the namespace of each
// instruction set that this build contains; SDFGRID_SELECT_ISA(name) is the one of active_isa(),
// for sources that include core/isa.h.
#pragma once

#if defined(__x86_64__)
#define SDFGRID_DECLARE_ISAS(...) \
  namespace baseline {            \
  __VA_ARGS__;                    \
  }                               \
  namespace avx2 {                \
  __VA_ARGS__;                    \
  }                               \
  namespace avx512 {              \
  __VA_ARGS__;                    \
  }
#define SDFGRID_SELECT_ISA(name)                                               \
  (::sdfgrid::active_isa() == ::sdfgrid::Isa::avx512 ? ::sdfgrid::avx512::name \
   : ::sdfgrid::active_isa() == ::sdfgrid::Isa::avx2 ? ::sdfgrid::avx2::name   \
                                                     : ::sdfgrid::baseline::name)
#else
#define SDFGRID_DECLARE_ISAS(...) \
  namespace baseline {            \
  __VA_ARGS__;                    \
  }
#define SDFGRID_SELECT_ISA(name) (::sdfgrid::baseline::name)
#endif
