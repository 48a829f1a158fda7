#include "sdfgrid/scene/words.h"

#include <algorithm>
#include <cmath>

namespace sdfgrid {
namespace {

constexpr Parameter file_of(const char* text) {
  return {"file", ParameterKind::text, "", {NAN, 0, 0}, 0, 0, text};
}
constexpr OpInfo kGrid = {
    "grid",
    OpRole::leaf,
    OpGuarantee::bound,
    "A sparse grid from a file, by trilinear interpolation, flattened where that is steeper than a "
    "distance. Under `offset` and `shell` its own levels count; ops that look beyond its band are "
    "refused.",
    "grid: {file: bunny.vdb}",
    ""};
constexpr Parameter kGridParameters[] = {
    file_of("a .vdb that `convert` or `sculpt` wrote; relative to the scene's file")};
constexpr OpInfo kMesh = {
    "mesh",
    OpRole::leaf,
    OpGuarantee::bound,
    "A mesh from a file, converted to a grid with as wide a band as the ops around it need; "
    "otherwise as `grid`.",
    "mesh: {file: bunny.off, dim: 128}",
    ""};
constexpr Parameter kMeshParameters[] = {
    file_of(".obj, .ply, .stl, .off or .om; relative to the scene's file"),
    {"dim", ParameterKind::whole, "voxels", {kMeshDim, 0, 0}, 2, 4096, "along its longest side"}};
constexpr OpInfo kDisplace = {
    "displace",
    OpRole::range,
    OpGuarantee::bound,
    "Another way to write `noise_displace`, `formula_displace` and `texture_displace`.",
    "displace: {by: {noise: {frequency: 2, amplitude: 0.1}}, of: {sphere: {radius: 1}}}",
    ""};
constexpr Parameter kDisplaceParameters[] = {{"by",
                                              ParameterKind::text,
                                              "",
                                              {NAN, 0, 0},
                                              0,
                                              0,
                                              "noise, formula or texture, with what that takes"}};
constexpr OpEntry kWords[] = {
    {&kGrid, kGridParameters}, {&kMesh, kMeshParameters}, {&kDisplace, kDisplaceParameters}};

}  // namespace

std::span<const OpEntry> scene_words() { return kWords; }

bool find_node_word(std::string_view word, NodeWord& found) {
  const OpEntry* op = find_op(word);
  if (word == kGrid.name) op = &kWords[0];
  if (word == kMesh.name) op = &kWords[1];
  if (op == nullptr) return false;
  found = {{}, {}, op->info->role == OpRole::leaf, {}};
  for (const Parameter& p : op->parameters) {
    (p.kind == ParameterKind::text ? found.texts : found.numbers).emplace_back(p.name);
    if (std::isinf(p.hi)) found.endless.emplace_back(p.name);
  }
  return true;
}

const std::vector<std::string>& node_words() {
  static const std::vector<std::string> words = [] {
    std::vector<std::string> all;
    for (const OpEntry& word : kWords) all.emplace_back(word.info->name);
    for (const OpEntry& op : op_list()) all.emplace_back(op.info->name);
    return all;
  }();
  return words;
}

}  // namespace sdfgrid
