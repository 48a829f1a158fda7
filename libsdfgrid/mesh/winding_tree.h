// mesh/winding_tree.h: builds the tree that the winding number's kernel walks (not installed).
#pragma once

#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/mesh/soup.h"
#include "sdfgrid/mesh/winding_kernel.h"
#include "sdfgrid/mesh/winding_moments.h"

namespace sdfgrid::winding {

struct Tree {
  std::vector<Node> nodes;  // the root first; empty if no triangle has an area
  std::vector<Leaf> leaves;
  double scale = 1.0;  // a power of two, so that scaling to about one loses nothing

  [[nodiscard]] TreeView view() const { return {nodes.data(), leaves.data(), scale}; }
};

// The result does not depend on the number of threads. Throws Error{cancelled} if `job` is.
[[nodiscard]] Tree build_tree(const TriangleSoup& soup, const Accuracy& accuracy, const Job& job);

}  // namespace sdfgrid::winding
