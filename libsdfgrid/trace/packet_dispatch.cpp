// Chooses the packet kernel for this machine; declared in packet_kernel.h.
#include "sdfgrid/core/isa.h"
#include "sdfgrid/trace/packet_kernel.h"

namespace sdfgrid {

const PacketKernel& packet_kernel() {
#if defined(__x86_64__)
  switch (active_isa()) {
    case Isa::avx512:
      return avx512::kPacketKernel;
    case Isa::avx2:
      return avx2::kPacketKernel;
    case Isa::baseline:
      break;
  }
#endif
  return baseline::kPacketKernel;
}

}  // namespace sdfgrid
