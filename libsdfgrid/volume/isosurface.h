// volume/isosurface.h: the surface in a volume at one value, as a closed mesh.
#pragma once

#include "sdfgrid/core/job.h"
#include "sdfgrid/mesh/soup.h"
#include "sdfgrid/volume/volume.h"

namespace sdfgrid {

struct IsosurfaceOptions {
  double iso = 0;
  // Inside are the samples >= iso; else those < iso, as in a volume of signed distances.
  bool inside_above = true;
};

// Marching cubes (Lorensen and Cline 1987) without a table: on each face of a cell the crossings of
// its edges are joined as the bilinear interpolant there does it (the asymptotic decider of Nielson
// and Hamann 1991), so that neighbouring cells agree and the mesh is closed; the loops that arise
// are filled with triangles, those longer than four around a point of the trilinear surface. Beyond
// the volume everything is outside: the surface is closed along the outermost samples.
//
// Points are in world units, counter-clockwise seen from outside. A crossing keeps 1/4096 of an
// edge between itself and the samples, so that no triangle has zero area where samples equal iso.
// The mesh is within 0.2 spacings of the trilinear interpolant's surface where that is smooth on
// the scale of a cell (tests/volume), and exact on the cells' edges. Tunnels within one cell are
// not resolved.
//
// Throws Error{input} if no sample lies on the surface's inside or all are at it beyond 2^32
// points, Error{cancelled}. The same mesh at any number of threads.
[[nodiscard]] TriangleSoup isosurface(const Volume& volume, const IsosurfaceOptions& options,
                                      const Job& job);

}  // namespace sdfgrid
