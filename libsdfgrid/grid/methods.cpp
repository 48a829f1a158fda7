#include "sdfgrid/grid/methods.h"

#include "sdfgrid/grid/peers.h"

namespace sdfgrid {
namespace {

std::vector<ConvertMethod> make_methods() {
  std::vector<ConvertMethod> all;
  all.push_back({"exact", "exact distances at every sample", false,
                 [](const TriangleSoup& soup, const ConvertOptions& options, const Job& job) {
                   return convert_mesh(soup, options, job);
                 }});
  all.push_back({"openvdb", "OpenVDB's meshToVolume", true, convert_by_openvdb});
  all.push_back({"sweep", "OpenVDB's fast sweeping from exact seeds", true, convert_by_sweeping});
  return all;
}

}  // namespace

const std::vector<ConvertMethod>& convert_methods() {
  static const std::vector<ConvertMethod> all = make_methods();
  return all;
}

}  // namespace sdfgrid
