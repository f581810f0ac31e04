#pragma once
/// The depths that can occur between voxel centres, each with a code.
///
/// A squared distance between centres is a sum of three squares of whole steps, so within the depth
/// that is stored there are few of them (cubic voxels: 282; any spacing: below 4096): a code names
/// one exactly. Codes ascend with depth, so that the shallow ones, which most bricks get by with,
/// fit six bits. Length unit: the smallest spacing s.
///
/// Order: kFarCode (outside, farther than any corner of a cell that has one inside), the outside
/// distances from the farthest to the nearest, the inside depths from the shallowest to the
/// deepest, the deepest of all standing for everything from there on, then the rungs of deep
/// bricks (deep_bricks.h).

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace palpate {

/// Deeper than this many smallest spacings, depths saturate (design).
inline constexpr double kSaturationVoxels = 16.0;
/// Longest to shortest edge of a voxel. Scans stay below 20; a palette holds every distance within
/// a voxel's diagonal, so a forged ratio would take all memory, or overflow.
inline constexpr double kMaxSpacingRatio = 1000.0;

class DepthPalette {
 public:
  static constexpr std::size_t kNarrow = 64;   ///< Codes of six bits.
  static constexpr std::size_t kCodes = 4096;  ///< Codes of twelve bits.
  static constexpr std::size_t kTabled = 384;  ///< Codes in byte tables, for vectors.
  static constexpr std::uint16_t kFarCode = 0;
  static constexpr std::uint16_t kRungs = 64;

  DepthPalette() = default;
  /// @param spacing  > 0, any unit, within kMaxSpacingRatio.
  explicit DepthPalette(const Eigen::Vector3d& spacing);

  /// Square steps along x, y, z in s², as the transform adds them up: (x + y) + z, single
  /// precision.
  [[nodiscard]] const std::array<float, 3>& weight() const noexcept { return weight_; }
  /// Squares beyond these, outside and inside, are the far code and the deepest code.
  [[nodiscard]] float farSquare() const noexcept { return farSquare_; }
  [[nodiscard]] float deepSquare() const noexcept { return deepSquare_; }
  /// Code of a signed squared distance (> 0 outside, < 0 inside).
  [[nodiscard]] std::uint16_t codeOf(float signedSquare) const noexcept;
  [[nodiscard]] std::uint16_t deepestCode() const noexcept { return deepest_; }
  /// The first code whose depth is at least kSaturationVoxels.
  [[nodiscard]] std::uint16_t saturatedCode() const noexcept { return saturated_; }
  /// Rung r of a ladder of depths, all beyond saturation, in even steps.
  [[nodiscard]] std::uint16_t rung(int r) const noexcept {
    return static_cast<std::uint16_t>(deepest_ + 1 + r);
  }

  /// Signed D in s: > 0 outside. Exact to single precision.
  [[nodiscard]] float value(std::uint16_t code) const noexcept { return value_[code]; }
  /// The signed square of a code that is not a rung, > 0 outside; of kFarCode and the deepest the
  /// least that they stand for.
  [[nodiscard]] float square(std::uint16_t code) const noexcept { return square_[code]; }
  /// The same in whole steps: value · stepsPerUnit, rounded.
  [[nodiscard]] std::int16_t steps(std::uint16_t code) const noexcept { return steps_[code]; }
  [[nodiscard]] const std::int16_t* stepsTable() const noexcept { return steps_.data(); }
  [[nodiscard]] float stepsPerUnit() const noexcept { return stepsPerUnit_; }
  /// Two narrow codes, low six bits first, to two depths in steps, low half first.
  [[nodiscard]] const std::uint32_t* pairTable() const noexcept { return pairs_.data(); }
  /// Low and high bytes of the first kTabled codes' steps: all of cubic voxels.
  [[nodiscard]] const std::uint8_t* lowBytes() const noexcept { return low_.data(); }
  [[nodiscard]] const std::uint8_t* highBytes() const noexcept { return high_.data(); }

 private:
  void setCode(std::size_t code, double value);

  std::array<float, 3> weight_{1, 1, 1};
  float farSquare_ = 0, deepSquare_ = 0, stepsPerUnit_ = 1;
  std::uint16_t deepest_ = 0, saturated_ = 0;
  std::vector<float> square_;             // signed, by code, for codeOf
  std::vector<std::uint16_t> firstCode_;  // by whole part of the square, inside
  std::vector<float> value_;
  std::vector<std::int16_t> steps_;
  std::vector<std::uint32_t> pairs_;
  alignas(64) std::array<std::uint8_t, kTabled> low_{}, high_{};
  std::uint16_t firstInside_ = 0;
};

}  // namespace palpate
