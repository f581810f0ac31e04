#pragma once
/// What the prototype reads in a step.
///
/// A 64-ary tree: level 1 nodes are blocks of 4³ cells, level 2 nodes of 16³. `top` has a word for
/// every block of 16³, `words` 64 of them for every level 2 node that is there. A word is a link
/// (bit 31) or an affine clearance: no point of the contact region is nearer to u than
/// b + g·(u - c), c the block's centre; lengths in units of the smallest spacing.
///
/// A level 1 node's brick is 128 bytes: 5³ codes, x fastest, then a clearance in 24 bits. A code
/// names one of 256 depths. Where those don't suffice (deep inside with unequal spacings) the brick
/// is wide: it holds the low bytes of 16-bit depths, and the next brick the high bytes.

#include <array>
#include <cstdint>

#include "tests/benchmarks/huge_buffer.h"
#include "tests/benchmarks/prototype/prototype.h"

namespace palpate::bench {

inline constexpr std::uint32_t kLink = 0x80000000U;
inline constexpr std::uint32_t kWide = 0x80000000U;  ///< in brickStart
inline constexpr std::size_t kBrickBytes = 128;
inline constexpr int kFineSide = 2;  ///< blocks of finer clearances along a brick
inline constexpr int kFineEdge = 4 / kFineSide;
inline constexpr int kFineWords = kFineSide * kFineSide * kFineSide;
inline constexpr float kFineSteps = 64;  ///< of their bounds in a unit of length
inline constexpr int kDepthUnit = 2048;  ///< steps of a stored depth in one unit of length

struct FastWorld {
  std::array<std::int32_t, 3> dims{0, 0, 0};
  std::array<double, 3> spacing{};
  double unit = 1e-3;
  std::array<float, 3> axis{1, 1, 1};     ///< spacing / unit
  std::int32_t topRow = 0, topSlice = 0;  ///< Blocks of 16³ along x, and in an xy layer.
  HugeBuffer<std::uint32_t> top;          ///< for spheres
  HugeBuffer<std::uint32_t> words;        ///< 64 a level 2 node; node 0 has no link
  HugeBuffer<std::uint32_t> topNode;      ///< for points: 64 · node, 0 for none
  HugeBuffer<std::uint32_t> brickStart;   ///< for points: like words, brick number or 0
  HugeBuffer<std::uint32_t> fine;         ///< for spheres: kFineWords a brick
  HugeBuffer<std::uint8_t> codes;         ///< kBrickBytes a brick; brick 0 is outside everywhere
  std::size_t bricks = 0, wideBricks = 0, nodes = 0;
  alignas(64) std::array<std::int32_t, 256> palette{};      ///< code -> depth in 1/kDepthUnit
  alignas(64) std::array<std::uint8_t, 256> low{}, high{};  ///< the same, by bytes
  HugeBuffer<std::int32_t>
      pairs;  ///< two codes -> two depths of 16 bits, for machines without VBMI
  alignas(64) std::array<std::uint8_t, 64> pick{};  ///< which bytes of four points' rows are codes
  double buildMs = 0;

  [[nodiscard]] std::size_t bytes() const {
    return top.size() * 8 + words.size() * 8 + fine.size() * 4 + pairs.size() * 4 + codes.size();
  }
};

}  // namespace palpate::bench
