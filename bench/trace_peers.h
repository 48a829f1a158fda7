// bench/trace_peers.h: the ray tracers that trace_bench measures ours against, behind one
// interface.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sdfgrid/grid/grid.h"
#include "sdfgrid/mesh/soup.h"
#include "sdfgrid/trace/camera.h"

namespace sdfgrid::bench {

// Traces the primary rays of the camera it was made for. Its rays are made beforehand, which ours
// are not: that favours the peer.
class Peer {
 public:
  virtual ~Peer() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  // Depth of every pixel in world units, +inf where nothing is hit, on the current thread limit.
  virtual void trace(std::vector<float>& depth) const = 0;
};

[[nodiscard]] std::unique_ptr<Peer> openvdb_peer(const Grid& grid, const Camera& camera);

// Null if the program was built without Embree. `width` rays at a time: 1 or 8.
[[nodiscard]] std::unique_ptr<Peer> embree_peer(const TriangleSoup& soup, const Camera& camera,
                                                int width);

}  // namespace sdfgrid::bench
