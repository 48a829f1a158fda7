// transform/chamfer.h: chamfer distances, the length of the shortest way in steps of a mask, after
// G. Borgefors, *Distance transformations in arbitrary dimensions* (1984). Two passes over a
// volume.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "sdfgrid/transform/transform.h"

namespace sdfgrid {

// The steps of the methods chamfer345, chamfer3 and chamfer5, of `options.steps` for chamfer_mask.
// Throws Error{usage} for a step that is out of range, or if no step of (1, 0, 0) is among them.
[[nodiscard]] std::vector<ChamferStep> chamfer_steps(const TransformOptions& options);

// Reads a mask from a file of text: a line `x y z length` a step, in voxels, # begins a comment.
// Throws Error{input} naming the line for what is no step as chamfer_steps() takes it, or if no
// step of (1, 0, 0) is among them.
[[nodiscard]] std::vector<ChamferStep> read_chamfer_steps(const std::string& path);

// How far chamfer distances are from Euclidean ones over all directions, for far-away samples.
struct ChamferRatio {
  double smallest;  // of chamfer / Euclidean distance
  double largest;   // divide by it, and no distance is overestimated
};

// With unequal spacing a step keeps its ratio to the Euclidean length of its offset.
[[nodiscard]] ChamferRatio chamfer_ratio(std::span<const ChamferStep> steps,
                                         const glm::dvec3& spacing = glm::dvec3(1.0));

}  // namespace sdfgrid
