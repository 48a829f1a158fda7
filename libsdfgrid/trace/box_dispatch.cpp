// Chooses the box kernel for this machine; declared in box_kernel.h.
#include "sdfgrid/core/isa.h"
#include "sdfgrid/trace/box_kernel.h"

namespace sdfgrid {

MeetBox meet_box() { return SDFGRID_SELECT_ISA(kMeetBox); }

}  // namespace sdfgrid
