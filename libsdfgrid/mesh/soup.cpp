#include "sdfgrid/mesh/soup.h"

namespace sdfgrid {

Box bounds(const TriangleSoup& soup) {
  Box box;
  for (const glm::uvec3& t : soup.triangles) {
    for (int k = 0; k < 3; ++k) box.add(soup.local(t[k]));
  }
  if (!box.empty()) {
    box.lo += soup.origin;
    box.hi += soup.origin;
  }
  return box;
}

}  // namespace sdfgrid
