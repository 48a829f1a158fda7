// Chooses the packet kernel for this machine; declared in packet_kernel.h.
#include "sdfgrid/core/isa.h"
#include "sdfgrid/trace/packet_kernel.h"

namespace sdfgrid {

const PacketKernel& packet_kernel() { return SDFGRID_SELECT_ISA(kPacketKernel); }

}  // namespace sdfgrid
