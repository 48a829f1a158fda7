// mesh/orient.h: makes meshes face outward.
#pragma once

#include <string>
#include <vector>

#include "sdfgrid/mesh/diagnose.h"
#include "sdfgrid/mesh/soup.h"

namespace sdfgrid {

// Turns components of a closed, consistently oriented soup so that outer shells face outward, those
// directly in them inward (a shell in a shell is a cavity), those in these outward again, and so
// on. A component is in another if the other winds round the centres of a sample of its triangles,
// all of them: components that merely overlap are outer shells both. Components without volume
// stay.
//
// `diagnosis` must be that of `soup`; its volume and flipped-ness are not brought up to date. Soups
// that are not closed or not consistently oriented are left alone. Returns warnings that count what
// was turned; none if all was well.
[[nodiscard]] std::vector<std::string> orient_closed_components(TriangleSoup& soup,
                                                                const MeshDiagnosis& diagnosis);

// Turns triangles that run along an edge in the same direction as their neighbour there, in each
// component the fewer ones. Components with edges of more than two triangles, and those that cannot
// agree (a Moebius strip), are left as they are. Returns how many triangles were turned.
std::size_t agree_with_neighbours(TriangleSoup& soup, const MeshDiagnosis& diagnosis);

struct Orientation {
  MeshDiagnosis diagnosis;  // of the soup whose neighbours agree; its volume is from before turning
  std::vector<std::string> warnings;
};

// Makes any mesh ready to be asked for inside and outside: neighbours agree where they can, closed
// components face as above, other meshes are turned whole if most of them faces inward, as the
// volume under their triangles tells. The warnings say what was turned, and that an open mesh has
// no definite inside. All who give distances signs do this first, so that they mean the same
// inside.
[[nodiscard]] Orientation orient_mesh(TriangleSoup& soup);

}  // namespace sdfgrid
