// voxelize/mesh_sign.h: which side of a mesh a sample is on.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/mesh/soup.h"
#include "sdfgrid/mesh/topology.h"

namespace sdfgrid {

class WindingNumber;

enum class SignMethod {
  automatic,  // normal where it is right (closed, consistently oriented, no zero-area face), else
              // winding
  normal,     // angle-weighted pseudonormal of the nearest feature
  winding,    // generalized winding number above one half
  no_sign,    // distances are not signed
};

[[nodiscard]] std::string sign_name(SignMethod method);  // "auto", "normal", "winding", "unsigned"

// A mesh that is ready to answer for signs: with the method chosen, and turned where that was
// needed.
struct SignedMesh {
  TriangleSoup soup;
  SignMethod method = SignMethod::no_sign;       // never automatic
  std::string reason;                            // why that method
  std::vector<std::string> warnings;             // what was turned, what is doubtful
  std::shared_ptr<const Topology> topology;      // for normal
  std::shared_ptr<const WindingNumber> winding;  // for winding
};

// Chooses the method, turns the components of closed meshes so that nested shells alternate (see
// orient.h), and builds what the method needs. Throws Error{input} if `normal` is asked for a mesh
// that has no inside: the message counts what is wrong.
[[nodiscard]] SignedMesh prepare_sign(TriangleSoup soup, SignMethod method, const Job& job);

// Changes a mesh that was prepared for another method to winding numbers.
void sign_by_winding(SignedMesh& mesh, std::string reason, const Job& job);

}  // namespace sdfgrid
