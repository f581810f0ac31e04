/// Filters in slabs: however few slices a slab holds, the result is that of the whole at once.

#include "imaging/segment/blur.h"
#include "imaging/segment/morphology.h"
#include "tests/imaging/segment/samples.h"

namespace palpate::test {
namespace {

using plane::kA;
using plane::kB;
using plane::kMask;

/// Random blobs of a few voxels, so that there are slices without one and slices that are full.
MaskBlock randomBlock(Random& random) {
  MaskBlock block;
  block.dims = {random.whole(3, 12), random.whole(3, 12), random.whole(2, 40)};
  block.box = {{0, 0, 0}, {block.dims[0] - 1, block.dims[1] - 1, block.dims[2] - 1}};
  block.spacing_mm = random.point(0.3, 2.0);
  block.voxels.assign(block.sliceVoxels() * static_cast<std::size_t>(block.dims[2]), 0);
  std::int32_t z = 0;
  while (z < block.dims[2]) {
    const std::int32_t end = std::min(block.dims[2], z + random.whole(1, 8));
    const int percent = random.chance(25) ? 0 : random.chance(25) ? 100 : random.whole(1, 99);
    for (std::size_t i = block.index(0, 0, z); i < block.index(0, 0, end); ++i) {
      block.voxels[i] = random.chance(percent) ? kMask : std::uint8_t{0};
      if (random.chance(10)) block.voxels[i] |= kA;  // what a filter writes is cleared elsewhere
    }
    z = end;
  }
  return block;
}

using Filter = Result<void> (*)(MaskBlock&, std::uint8_t, std::uint8_t, double, const Share&);

void expectSlabsEqualTheWhole(Filter filter, double most_mm) {
  const Progress progress;
  for (unsigned seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const MaskBlock block = randomBlock(random);
    const double mm = random.real(0.05, most_mm);
    MaskBlock whole = block;
    ASSERT_TRUE(filter(whole, kMask, kA, mm, {progress}));
    for (const std::size_t slices : {0, 1, 3, 7}) {
      MaskBlock slabs = block;
      slabs.slabBytes = slices * 18 * block.sliceVoxels();
      ASSERT_TRUE(filter(slabs, kMask, kA, mm, {progress}));
      ASSERT_EQ(slabs.voxels, whole.voxels) << slices << " slices, " << mm << " mm";
    }
  }
}

TEST(Slabs, DilateAsTheWhole) {
  expectSlabsEqualTheWhole(dilate, 6.0);
}

TEST(Slabs, ErodeAsTheWhole) {
  expectSlabsEqualTheWhole(erode, 6.0);
}

TEST(Slabs, BlurAsTheWhole) {
  expectSlabsEqualTheWhole(blurAndCut, 3.0);
}

/// 2.4 / 0.8 is a little less than 3 in binary numbers.
TEST(Slabs, AWholeNumberOfSlicesIsReachedAcrossTheirBorder) {
  const Progress progress;
  MaskBlock block;
  block.dims = {2, 2, 20};
  block.box = {{0, 0, 0}, {1, 1, 19}};
  block.spacing_mm = {1.0, 1.0, 0.8};
  block.voxels.assign(80, 0);
  block.slabBytes = 0;
  for (std::int32_t z = 0; z < 20; ++z) {
    MaskBlock one = block;
    one.voxels[one.index(0, 0, z)] = kMask;
    ASSERT_TRUE(dilate(one, kMask, kA, 2.4, {progress}));
    for (std::int32_t k = 0; k < 20; ++k) {
      EXPECT_EQ((one.voxels[one.index(0, 0, k)] & kA) != 0, std::abs(k - z) <= 3) << z << " " << k;
    }
  }
}

TEST(Slabs, OneHoldsAtLeastASliceAndItsBorders) {
  MaskBlock block;
  block.dims = {10, 10, 100};
  block.slabBytes = 0;
  EXPECT_EQ(slabSlices(block, 0, 10), 1);
  EXPECT_EQ(slabSlices(block, 7, 10), 7);
  block.slabBytes = 1001 * 50;
  EXPECT_EQ(slabSlices(block, 0, 10), 50);
  EXPECT_EQ(slabSlices(block, 5, 10), 40) << "its borders are within its bytes";
}

TEST(Slabs, AllPlanesButTheOneWrittenStay) {
  const Progress progress;
  for (const Filter filter : {Filter{dilate}, Filter{erode}, Filter{blurAndCut}}) {
    Random random(3);
    MaskBlock block = randomBlock(random);
    for (auto& voxel : block.voxels) voxel |= random.chance(50) ? kB : std::uint8_t{0};
    const MaskBlock before = block;
    ASSERT_TRUE(filter(block, kMask, kA, 1.0, {progress}));
    for (std::size_t i = 0; i < block.voxels.size(); ++i) {
      ASSERT_EQ(block.voxels[i] | kA, before.voxels[i] | kA) << i;
    }
  }
}

}  // namespace
}  // namespace palpate::test
