#include "core/voxels/voxel_bits.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace palpate {
namespace {

constexpr std::uint32_t kSeed = 811;

// A bit a byte and nothing clever.
struct Plain {
  Extent3 extent;
  std::vector<std::uint8_t> bit;

  explicit Plain(const Extent3& size)
      : extent(size),
        bit(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
            static_cast<std::size_t>(size[2])) {}
  [[nodiscard]] std::size_t at(int i, int j, int k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(extent[0]) *
               (static_cast<std::size_t>(j) +
                static_cast<std::size_t>(extent[1]) * static_cast<std::size_t>(k));
  }
  [[nodiscard]] bool test(int i, int j, int k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < extent[0] && j < extent[1] && k < extent[2] &&
           bit[at(i, j, k)] != 0;
  }
  template <class F>
  void fill(F&& f) {
    for (int k = 0; k < extent[2]; ++k) {
      for (int j = 0; j < extent[1]; ++j) {
        for (int i = 0; i < extent[0]; ++i) bit[at(i, j, k)] = f(i, j, k) ? 1 : 0;
      }
    }
  }
};

void expectSame(const VoxelBits& found, const Plain& expected) {
  ASSERT_EQ(found.extent, expected.extent);
  std::size_t count = 0;
  for (int k = 0; k < expected.extent[2]; ++k) {
    for (int j = 0; j < expected.extent[1]; ++j) {
      for (int i = 0; i < expected.extent[0]; ++i) {
        ASSERT_EQ(found.test(i, j, k), expected.test(i, j, k)) << i << " " << j << " " << k;
        count += expected.test(i, j, k) ? 1U : 0U;
      }
    }
  }
  EXPECT_EQ(found.count(), count);  // so no bit past the extent is set
}

// Around whole words along x, around whole blocks along y and z.
std::vector<Extent3> extents(std::int32_t least) {
  std::vector<Extent3> all;
  for (const std::int32_t x : {1, 2, 63, 64, 65, 127, 128, 129}) {
    for (const std::int32_t y : {1, 2, 5, 17}) {
      for (const std::int32_t z : {1, 3, 8}) {
        if (std::min({x, y, z}) >= least) all.push_back({x, y, z});
      }
    }
  }
  return all;
}

template <class F>
void forRandomBits(std::int32_t least, F&& f) {
  std::mt19937 rng(kSeed);
  for (const Extent3& extent : extents(least)) {
    for (const double share : {0.0, 0.02, 0.5, 0.97, 1.0}) {
      SCOPED_TRACE("seed " + std::to_string(kSeed) + ", extent " + std::to_string(extent[0]) + " " +
                   std::to_string(extent[1]) + " " + std::to_string(extent[2]) + ", share " +
                   std::to_string(share));
      Plain plain(extent);
      plain.fill(
          [&](int, int, int) { return std::uniform_real_distribution<double>(0, 1)(rng) < share; });
      VoxelBits bits(extent);
      for (int k = 0; k < extent[2]; ++k) {
        for (int j = 0; j < extent[1]; ++j) {
          for (int i = 0; i < extent[0]; ++i) {
            if (plain.test(i, j, k)) bits.set(i, j, k);
          }
        }
      }
      f(plain, bits);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

TEST(VoxelBits, HoldWhatIsSet) {
  forRandomBits(1, [](const Plain& plain, const VoxelBits& bits) { expectSame(bits, plain); });
}

TEST(VoxelBits, PackingKeepsExactlyTheWantedValues) {
  std::mt19937 rng(kSeed);
  for (const Extent3& extent : extents(1)) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", extent " + std::to_string(extent[0]) + " " +
                 std::to_string(extent[1]) + " " + std::to_string(extent[2]));
    std::array<std::uint8_t, 256> wanted{};
    for (auto& w : wanted) w = rng() % 3 == 0 ? static_cast<std::uint8_t>(1 + rng() % 255) : 0;
    Plain plain(extent);
    std::vector<std::uint8_t> bytes(plain.bit.size());
    for (auto& b : bytes) b = static_cast<std::uint8_t>(rng());
    plain.fill([&](int i, int j, int k) { return wanted[bytes[plain.at(i, j, k)]] != 0; });
    expectSame(packBits(extent, bytes, wanted), plain);
    if (HasFatalFailure()) return;
  }
}

TEST(VoxelBits, TheSurfaceIsWhatHasAnEmptyFaceNeighbourOrTheGridsEdge) {
  forRandomBits(1, [](const Plain& plain, const VoxelBits& bits) {
    Plain expected(plain.extent);
    expected.fill([&](int i, int j, int k) {
      return plain.test(i, j, k) &&
             !(plain.test(i - 1, j, k) && plain.test(i + 1, j, k) && plain.test(i, j - 1, k) &&
               plain.test(i, j + 1, k) && plain.test(i, j, k - 1) && plain.test(i, j, k + 1));
    });
    expectSame(surfaceOf(bits), expected);
  });
}

TEST(VoxelBits, CellsAreThoseWithACornerThatIsSet) {
  forRandomBits(2, [](const Plain& plain, const VoxelBits& bits) {
    Plain expected({plain.extent[0] - 1, plain.extent[1] - 1, plain.extent[2] - 1});
    expected.fill([&](int i, int j, int k) {
      bool any = false;
      for (int c = 0; c < 8; ++c)
        any = any || plain.test(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
      return any;
    });
    expectSame(cellsOf(bits), expected);
  });
}

TEST(VoxelBits, ACoarserBoxIsSetWhereItHoldsAnything) {
  forRandomBits(1, [](const Plain& plain, const VoxelBits& bits) {
    for (const int shift : {1, 2, 3, 4, 6}) {
      const int edge = 1 << shift;
      Plain expected({(plain.extent[0] + edge - 1) / edge, (plain.extent[1] + edge - 1) / edge,
                      (plain.extent[2] + edge - 1) / edge});
      for (int k = 0; k < plain.extent[2]; ++k) {
        for (int j = 0; j < plain.extent[1]; ++j) {
          for (int i = 0; i < plain.extent[0]; ++i) {
            if (plain.test(i, j, k)) {
              expected.bit[expected.at(i >> shift, j >> shift, k >> shift)] = 1;
            }
          }
        }
      }
      expectSame(coarser(bits, shift), expected);
    }
  });
}

}  // namespace
}  // namespace palpate
