// grid/methods.h: all the ways from a mesh to a distance grid under one signature, ours and the
// peers that they are measured against.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/mesh/soup.h"

namespace sdfgrid {

struct ConvertMethod {
  std::string name;  // as on the command line
  std::string help;  // half a sentence
  bool peer = false;
  bool needs_steps = false;  // a chamfer mask of the caller's, in ConvertOptions::transform
  std::optional<TransformMethod> transform{};  // of exact seeds; none for exact and peers
  // Of the options' transform, the bucket width and steps count. Throws as convert_mesh() does.
  std::function<Conversion(const TriangleSoup& soup, const ConvertOptions& options, const Job& job)>
      convert;
};

// The one list of methods for meshes, which `convert`, `chart`, `--tolerance` and the tests share.
// Exact first, then every transform that transform_methods() has for meshes, then the peers:
// - `openvdb`: OpenVDB's meshToVolume;
// - `sweep`: OpenVDB's fast sweeping (dilateSdf) from our exact seeds of half-width 1.
[[nodiscard]] const std::vector<ConvertMethod>& convert_methods();

// Null if there is no such method.
[[nodiscard]] const ConvertMethod* find_convert_method(std::string_view name);

// Those of the list that `names` names, in the list's order; without names all that the options
// have what is needed for, peers if `peers`. Throws Error{usage} for an unknown name, and for one
// that needs steps without any.
[[nodiscard]] std::vector<ConvertMethod> select_methods(const std::vector<std::string>& names,
                                                        const ConvertOptions& options, bool peers);

}  // namespace sdfgrid
