// That no conversion takes more memory than its estimate, on which --max-memory relies.
#include "sdfgrid/core/memory.h"

#include <gtest/gtest.h>

#include "property/random_meshes.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/grid/methods.h"

namespace sdfgrid {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kOwnAllocator = true;
#else
constexpr bool kOwnAllocator = false;
#endif

TEST(ConvertMemory, PeakIsWithinTheEstimateForEveryMethod) {
  if (kOwnAllocator) GTEST_SKIP() << "the sanitizer's allocator keeps what is freed";
  const TriangleSoup box = shapes::box_mesh(glm::dvec3(-1), glm::dvec3(1));
  ConvertOptions options;
  options.dim = 400;
  options.transform.emplace().steps = {{{1, 0, 0}, 1.0}, {{1, 1, 0}, 1.41}, {{1, 1, 1}, 1.73}};
  for (const ConvertMethod& method : select_methods({}, options, false)) {
    ConvertOptions asked = options;
    if (method.name == "exact") {
      asked.transform.reset();
    } else {
      for (const TransformMethodInfo& info : transform_methods()) {
        if (info.name == method.name) asked.transform->method = info.method;
      }
    }
    const double estimate = estimate_memory(box, choose_lattice(box, asked), asked);
    const PeakMemory peak;
    const Conversion made = method.convert(box, asked, Job());
    EXPECT_LT(peak.bytes(), estimate) << method.name;
    EXPECT_GT(peak.bytes(), static_cast<double>(made.grid.bytes())) << method.name;
  }
}

}  // namespace
}  // namespace sdfgrid
