#include "sdfgrid/grid/methods.h"

#include <algorithm>

#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/peers.h"

namespace sdfgrid {
namespace {

Conversion convert_exactly(const TriangleSoup& soup, const ConvertOptions& options,
                           const Job& job) {
  ConvertOptions exact = options;
  exact.transform.reset();
  return convert_mesh(soup, exact, job);
}

ConvertMethod method_of(const TransformMethodInfo& info) {
  ConvertMethod method;
  method.name = info.name;
  method.help = info.help;
  method.needs_steps = info.steps;
  method.transform = info.method;
  method.convert = [transform = info.method](const TriangleSoup& soup,
                                             const ConvertOptions& options, const Job& job) {
    ConvertOptions with = options;
    if (!with.transform) with.transform.emplace();
    with.transform->method = transform;
    return convert_mesh(soup, with, job);
  };
  return method;
}

std::vector<ConvertMethod> make_methods() {
  std::vector<ConvertMethod> all;
  all.push_back(
      {"exact", "exact distances at every sample", false, false, std::nullopt, convert_exactly});
  for (const TransformMethodInfo& info : transform_methods()) {
    if (info.meshes) all.push_back(method_of(info));
  }
  all.push_back(
      {"openvdb", "OpenVDB's meshToVolume", true, false, std::nullopt, convert_by_openvdb});
  all.push_back({"sweep", "OpenVDB's fast sweeping from exact seeds", true, false, std::nullopt,
                 convert_by_sweeping});
  return all;
}

}  // namespace

const std::vector<ConvertMethod>& convert_methods() {
  static const std::vector<ConvertMethod> all = make_methods();
  return all;
}

const ConvertMethod* find_convert_method(std::string_view name) {
  const auto& all = convert_methods();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const auto& method) { return method.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::vector<ConvertMethod> select_methods(const std::vector<std::string>& names,
                                          const ConvertOptions& options, bool peers) {
  const bool have_steps = options.transform && !options.transform->steps.empty();
  for (const std::string& name : names) {
    const ConvertMethod* method = find_convert_method(name);
    if (method == nullptr) throw Error(ErrorKind::usage, "there is no method " + name);
    if (method->needs_steps && !have_steps) {
      throw Error(ErrorKind::usage, "the method " + name + " needs the steps of a mask");
    }
  }
  std::vector<ConvertMethod> selected;
  for (const ConvertMethod& method : convert_methods()) {
    const bool named = std::find(names.begin(), names.end(), method.name) != names.end();
    const bool usable = (peers || !method.peer) && (have_steps || !method.needs_steps);
    if (names.empty() ? usable : named) selected.push_back(method);
  }
  return selected;
}

}  // namespace sdfgrid
