// The same volumes by ITK (libinsighttoolkit5-dev), where it was found.
#include <fmt/format.h>

#include "transform_bench.h"

#ifdef SDFGRID_BENCH_WITH_ITK
#include <itkFastChamferDistanceImageFilter.h>
#include <itkImage.h>
#include <itkSignedMaurerDistanceMapImageFilter.h>

#include <algorithm>
#include <cmath>
#endif

namespace sdfgrid::bench {

#ifdef SDFGRID_BENCH_WITH_ITK
namespace {

using Mask = itk::Image<std::uint8_t, 3>;
using Distances = itk::Image<float, 3>;

// ITK's first index is the fastest one, the last of ours: a ball does not mind.
template <class Image>
typename Image::Pointer make_image(const glm::ivec3& dims) {
  auto image = Image::New();
  typename Image::SizeType size;
  for (unsigned a = 0; a < 3; ++a) size[a] = static_cast<itk::SizeValueType>(dims[2 - int(a)]);
  image->SetRegions(size);
  image->Allocate();
  return image;
}

}  // namespace

void run_itk(const glm::ivec3& dims, const std::vector<std::uint8_t>& mask, int repetitions) {
  const auto inside = make_image<Mask>(dims);
  std::copy(mask.begin(), mask.end(), inside->GetBufferPointer());
  const double maurer = best_seconds(repetitions, [&] {
    const auto filter = itk::SignedMaurerDistanceMapImageFilter<Mask, Distances>::New();
    filter->SetInput(inside);
    filter->SetSquaredDistance(false);
    filter->SetUseImageSpacing(false);
    filter->SetNumberOfWorkUnits(1);
    filter->Update();
  });
  print_speed(fmt::format("ITK SignedMaurer {}^3 ball, signed", dims.x), mask.size(), maurer, 1);

  // The filter replaces its input: half a voxel beside the surface, far elsewhere.
  const auto seeds = make_image<Distances>(dims);
  double chamfer = 1e300;
  for (int r = 0; r < repetitions; ++r) {
    const float far = static_cast<float>(dims.x);
    const std::size_t ny = static_cast<std::size_t>(dims.y);
    const std::size_t nz = static_cast<std::size_t>(dims.z);
    for (std::size_t i = 0; i < mask.size(); ++i) {
      const std::size_t strides[3] = {1, nz, ny * nz};
      bool beside = false;
      for (const std::size_t stride : strides) {
        beside = beside || (i >= stride && mask[i - stride] != mask[i]) ||
                 (i + stride < mask.size() && mask[i + stride] != mask[i]);
      }
      seeds->GetBufferPointer()[i] = (mask[i] != 0 ? -1.0F : 1.0F) * (beside ? 0.5F : far);
    }
    const auto filter = itk::FastChamferDistanceImageFilter<Distances, Distances>::New();
    filter->SetInput(seeds);
    filter->SetMaximumDistance(far);
    filter->SetNumberOfWorkUnits(1);
    chamfer = std::min(chamfer, best_seconds(1, [&] { filter->Update(); }));
  }
  print_speed(fmt::format("ITK FastChamfer {}^3 ball, signed", dims.x), mask.size(), chamfer, 1);
}
#else
void run_itk(const glm::ivec3&, const std::vector<std::uint8_t>&, int) {
  fmt::print("ITK was not found (libinsighttoolkit5-dev)\n");
}
#endif

}  // namespace sdfgrid::bench
