#include "imaging/itk_distance.h"

#include <itkImage.h>
#include <itkSignedMaurerDistanceMapImageFilter.h>

#include <algorithm>

namespace palpate {

std::vector<float> squaredDistances_mm2(const std::vector<std::uint8_t>& set,
                                        const std::array<std::int32_t, 3>& dims,
                                        const std::array<double, 3>& spacing_mm) {
  using Mask = itk::Image<std::uint8_t, 3>;
  using Distances = itk::Image<float, 3>;
  Mask::SizeType size;
  for (unsigned d = 0; d < 3; ++d) size[d] = static_cast<itk::SizeValueType>(dims[d]);
  const auto mask = Mask::New();
  mask->SetRegions(Mask::RegionType(size));
  mask->SetSpacing(spacing_mm.data());
  mask->Allocate();
  std::copy(set.begin(), set.end(), mask->GetBufferPointer());
  const auto filter = itk::SignedMaurerDistanceMapImageFilter<Mask, Distances>::New();
  filter->SetInput(mask);
  filter->SetSquaredDistance(true);
  filter->SetUseImageSpacing(true);
  filter->SetInsideIsPositive(false);
  filter->SetBackgroundValue(0);
  filter->Update();
  const float* out = filter->GetOutput()->GetBufferPointer();
  return {out, out + set.size()};
}

}  // namespace palpate
