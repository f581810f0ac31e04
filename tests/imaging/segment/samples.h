#pragma once
/// Random cases for the segmentation tools, and what their oracles share.
///
/// An oracle says which voxels the label would have if nothing limited the tool (`wanted`), and
/// where both answers are right (`either`); expectEdit() puts the limits on top and compares every
/// voxel, the table, and what was there before.

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "imaging/segment/apply.h"
#include "imaging/segment/tools.h"
#include "imaging/volume.h"

namespace palpate::test {

using Mask = std::vector<std::uint8_t>;
using Part = std::vector<std::size_t>;  ///< Voxels of one connected part.

/// The label that the tools work on. Its value is neither its row nor the lowest.
inline constexpr const char* kLabel = "tooth";
inline constexpr std::uint8_t kValue = 4;

class Random {
 public:
  explicit Random(unsigned seed) : bits_(seed) {}
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(bits_); }
  double real(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(bits_);
  }
  bool chance(int percent) { return whole(1, 100) <= percent; }
  Eigen::Vector3d point(double low, double high) {
    const double x = real(low, high);
    const double y = real(low, high);
    return {x, y, real(low, high)};
  }
  std::mt19937& bits() { return bits_; }

 private:
  std::mt19937 bits_;
};

/// A scan with labels bone (1), tooth (4) and nerve (9).
struct Sample {
  Volume volume;
  LabelState before;

  [[nodiscard]] const GridGeometry& geometry() const { return volume.geometry; }
  [[nodiscard]] std::size_t size() const { return volume.size(); }
  [[nodiscard]] bool holds(std::size_t i) const { return before.labels.labels[i] == kValue; }
  [[nodiscard]] Mask label() const;
};

/// Whole values in this range, halves between in a float32 scan: ends of ranges are often met.
inline constexpr int kLowest = -6;
inline constexpr int kHighest = 6;

/// Sizes from one voxel up to `maxSize` an axis, spacings from 0.3 to 2.5 mm, any pose.
Sample randomSample(Random& random, int maxSize = 9);
/// Seeds ascend with the size of the case, so that the first failure is a small one.
Sample sampleOfSeed(Random& random, unsigned seed);
GridGeometry randomGeometry(Random& random, const std::array<std::int32_t, 3>& dims);
/// A scan of one value with all of the label's voxels clear; spacing in mm, no rotation.
Sample plainSample(const std::array<std::int32_t, 3>& dims, const Eigen::Vector3d& spacing_mm);

ThresholdRange randomRange(Random& random);
EditLimits randomLimits(Random& random);
bool inRange(const Volume& volume, std::size_t i, const ThresholdRange& range);

struct Voxel {
  std::int32_t i = 0, j = 0, k = 0;
};
Voxel voxelOf(const GridGeometry& geometry, std::size_t index);
/// In P, millimetres; (i, j, k) may lie between voxels.
Eigen::Vector3d at_mm(const GridGeometry& geometry, double i, double j, double k);
Eigen::Vector3d centre_mm(const GridGeometry& geometry, std::size_t index);
/// Somewhere in the voxel, off its centre and off its faces.
Eigen::Vector3d somewhereIn_mm(Random& random, const GridGeometry& geometry, std::size_t index);
double voxelMm3(const GridGeometry& geometry);

/// Calls `visit` with each neighbour; `connectivity` is 6 or 26.
void forNeighbours(const GridGeometry& geometry, std::size_t index, int connectivity,
                   const std::function<void(std::size_t)>& visit);
/// Breadth first, by first voxel.
std::vector<Part> partsOf(const Mask& mask, const GridGeometry& geometry, int connectivity);
/// What of the mask is reached from the starts (those outside the mask start nothing).
Mask flooded(const Mask& mask, const Part& starts, const GridGeometry& geometry, int connectivity);
std::size_t countOf(const Mask& mask);
std::size_t voxelsOf(const LabelGrid& labels, std::uint8_t value);

Result<LabelState> applied(const Sample& sample, const LabelTool& tool,
                           const EditLimits& limits = {}, const std::string& label = kLabel);

/// The labels where the label should become `wanted`, under the limits.
LabelGrid edited(const Sample& sample, const EditLimits& limits, const Mask& wanted,
                 bool takesOthers = false);
void expectEdit(const Sample& sample, const LabelTool& tool, const EditLimits& limits,
                const Mask& wanted, const Mask& either = {}, bool takesOthers = false);
/// For a step that has nothing to work on (no seed in the range, no part near a pick): refused, or
/// as expectEdit().
void expectEditOrRefusal(const Sample& sample, const LabelTool& tool, const EditLimits& limits,
                         const Mask& wanted, const Mask& either = {}, bool takesOthers = false);
void expectRefused(const Sample& sample, const LabelTool& tool, ErrorKind kind,
                   const EditLimits& limits = {}, const std::string& label = kLabel);

bool sameRow(const LabelInfo& a, const LabelInfo& b);
bool sameTable(const LabelTable& a, const LabelTable& b);
bool sameState(const LabelState& a, const LabelState& b);
::testing::AssertionResult sameLabels(const LabelGrid& expected, const LabelGrid& got);
/// The case in a line or two, whole where it is small.
std::string describe(const Sample& sample);

/// Calls `test` with seeds 1 to `count` and a random sample each, until one fails.
void forSamples(unsigned count, const std::function<void(Random&, Sample&)>& test);

}  // namespace palpate::test
