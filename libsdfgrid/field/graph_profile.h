// field/graph_profile.h: what is below the graph of a function of one variable as a figure of
// circular arcs, within a tolerance that is proved (internal to field/).
#pragma once

#include <optional>
#include <vector>

#include "sdfgrid/field/ops.h"

namespace sdfgrid {

// Where low <= r <= f(u), from <= u <= to. `mirrored`: r is a distance from an axis, low is 0, and
// there is no border at r = low.
struct GraphRange {
  double from, to, low;
  double largest;  // of f, about
  bool mirrored;
};

struct GraphProfile {
  std::vector<float> list;  // boxes, then arcs: see Profile
  int count = 0;            // of arcs; none: the figure is empty
  int leaves = 1;
  double from = 0, to = 0, largest = 0;  // the figure's extent
};

// The border is that of the graph within 1e-6 times the lesser of the range's length and height,
// where f has kinks, jumps or infinite slopes within 4e-6 |f| if that is more. Nothing where f has
// no such chain of less than 32,768 arcs: near poles and where it oscillates without end.
[[nodiscard]] std::optional<GraphProfile> make_graph_profile(ops::Data code,
                                                             const GraphRange& range);

}  // namespace sdfgrid
