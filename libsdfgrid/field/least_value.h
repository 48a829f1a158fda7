// field/least_value.h: how low a field may be in a box, by intervals, best first.
#pragma once

#include <functional>

#include "sdfgrid/core/job.h"
#include "sdfgrid/field/field.h"

namespace sdfgrid {

struct LeastValue {
  double bound;  // no value is less
  double met;    // one that is no more than this was met; infinite if none was
};

// Looks where the field may be least first, and divides the box there, until `enough`, at most 4000
// times, and so often that no more than a million instructions are read. The box may be infinite:
// then it is divided where `content` is. Its values are `known` to be no less than that. Throws
// Error{cancelled}.
[[nodiscard]] LeastValue least_value(const Field& field, const Box& box, const Box& content,
                                     double known,
                                     const std::function<bool(const LeastValue&)>& enough,
                                     const Job& job);

}  // namespace sdfgrid
