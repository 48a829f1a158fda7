#include "sdfgrid/core/job.h"

#include "sdfgrid/core/error.h"

namespace sdfgrid {

void Job::checkpoint() const {
  if (cancelled()) throw Error(ErrorKind::cancelled, "interrupted");
}

}  // namespace sdfgrid
