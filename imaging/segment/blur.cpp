#include "imaging/segment/blur.h"

#include <vtkImageData.h>
#include <vtkImageGaussianSmooth.h>
#include <vtkNew.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

vtkNew<vtkImageData> imageOf(const MaskBlock& block, std::uint8_t from, std::int32_t first,
                             std::int32_t end) {
  vtkNew<vtkImageData> image;
  image->SetDimensions(block.dims[0], block.dims[1], end - first);
  image->AllocateScalars(VTK_FLOAT, 1);
  auto* values = static_cast<float*>(image->GetScalarPointer());
  const std::size_t begin = block.index(0, 0, first), stop = block.index(0, 0, end);
  std::transform(block.voxels.begin() + static_cast<std::ptrdiff_t>(begin),
                 block.voxels.begin() + static_cast<std::ptrdiff_t>(stop), values,
                 [from](std::uint8_t voxel) { return (voxel & from) != 0 ? 1.0F : 0.0F; });
  return image;
}

}  // namespace

Result<void> blurAndCut(MaskBlock& block, std::uint8_t from, std::uint8_t to, double mm,
                        const Share& share) {
  const std::int32_t nz = block.dims[2];
  const auto border = static_cast<std::int32_t>(
      std::min<double>(std::ceil(blurReach_mm(mm) / block.spacing_mm.z()), nz));
  // Input, output, and the two in between that VTK makes, one an axis.
  const std::int32_t thick = slabSlices(block, border, 4 * sizeof(float));
  for (std::int32_t first = 0; first < nz; first += thick) {
    if (share.progress.cancelled()) return fail(cancelled());
    share.at(static_cast<double>(first) / nz);
    const std::int32_t end = std::min(nz, first + thick);
    const std::int32_t first0 = std::max(0, first - border), end0 = std::min(nz, end + border);
    vtkNew<vtkImageGaussianSmooth> blur;
    const auto image = imageOf(block, from, first0, end0);
    blur->SetInputData(image);
    blur->SetDimensionality(3);
    blur->SetStandardDeviations(mm / block.spacing_mm.x(), mm / block.spacing_mm.y(),
                                mm / block.spacing_mm.z());
    blur->SetRadiusFactors(3.0, 3.0, 3.0);
    blur->Update();
    const auto* values = static_cast<const float*>(blur->GetOutput()->GetScalarPointer()) +
                         block.sliceVoxels() * static_cast<std::size_t>(first - first0);
    const std::size_t begin = block.index(0, 0, first), stop = block.index(0, 0, end);
    for (std::size_t i = begin; i < stop; ++i) {
      std::uint8_t& voxel = block.voxels[i];
      const bool in = values[i - begin] > 0.5F;
      voxel = static_cast<std::uint8_t>(in ? voxel | to : voxel & ~to);
    }
  }
  share.at(1.0);
  return {};
}

}  // namespace palpate
