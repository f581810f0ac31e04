#include "core/voxels/pattern_spheres.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

namespace palpate {
namespace {

template <int Bits>
std::size_t hashOf(const NodeMask<Bits>& mask) noexcept {
  // One odd factor and a fold a word: masks differ in few and in high bits alike, and the fold
  // brings both down to the bits that choose the slot.
  std::uint64_t h = 0;
  for (const std::uint64_t w : mask.word) {
    h = (h ^ w) * 0x9E3779B97F4A7C15U;
    h ^= h >> 32U;
  }
  return static_cast<std::size_t>(h);
}

template <int Bits>
NodeMask<Bits> maskAt(const std::vector<std::uint64_t>& patterns, std::size_t i) noexcept {
  using Mask = NodeMask<Bits>;
  Mask mask;
  std::copy_n(patterns.begin() + static_cast<std::ptrdiff_t>(i * Mask::kWords), Mask::kWords,
              mask.word.begin());
  return mask;
}

}  // namespace

PatternSpheres::PatternSpheres(int bits, const Eigen::Vector3d& cell, SphereKind kind,
                               std::span<const TreeLevel> level) {
  const SphereTable table(bits, cell);
  sphere_[0].radius = table.fullRadius(1);
  if (kind == SphereKind::Full) return;  // nothing to look up
  switch (bits) {
    case 1:
      fill<1>(table, kind, level);
      break;
    case 2:
      fill<2>(table, kind, level);
      break;
    default:
      fill<3>(table, kind, level);
  }
}

template <int Bits>
void PatternSpheres::fill(const SphereTable& table, SphereKind kind,
                          std::span<const TreeLevel> level) {
  using Mask = NodeMask<Bits>;
  pattern_.assign(Mask::kWords, 0);  // no node is empty, so none has the pattern of sphere 0
  if constexpr (Bits == 1) {
    for (std::uint64_t pattern = 1; pattern < 256; ++pattern) pattern_.push_back(pattern);
  } else {
    std::size_t count = 1;
    slot_.assign(64, 0);
    for (std::size_t l = 1; l < level.size(); ++l) {
      for (std::size_t n = 0; n * Mask::kBytes < level[l].masks.size(); ++n) {
        const Mask mask = Mask::load(level[l].masks.data(), n);
        std::size_t slot = slotOf(mask);
        if (mask.empty() || slot_[slot] != 0) continue;
        if (2 * count >= slot_.size()) {  // at most half full, so that probing stays short
          slot_.assign(slot_.size() * 2, 0);
          for (std::size_t i = 1; i < count; ++i) {
            slot_[slotOf(maskAt<Bits>(pattern_, i))] = static_cast<std::uint32_t>(i);
          }
          slot = slotOf(mask);
        }
        slot_[slot] = static_cast<std::uint32_t>(count++);
        pattern_.insert(pattern_.end(), mask.word.begin(), mask.word.end());
      }
    }
  }
  sphere_.resize(pattern_.size() / Mask::kWords);
  const Eigen::Vector3d& cell = table.cell();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(1, sphere_.size(), 256),
                    [&](const auto& range) {
                      for (std::size_t i = range.begin(); i != range.end(); ++i) {
                        const NodeSphere sphere = table.sphere(maskAt<Bits>(pattern_, i), 1, kind);
                        for (std::size_t a = 0; a < 3; ++a) {
                          const auto axis = static_cast<Eigen::Index>(a);
                          sphere_[i].offset[a] = sphere.offset[axis] / cell[axis];
                        }
                        sphere_[i].radius = sphere.radius;
                      }
                    });
}

// Where the pattern is, or the free slot where it would be.
template <int Bits>
std::size_t PatternSpheres::slotOf(const NodeMask<Bits>& mask) const noexcept {
  const std::size_t last = slot_.size() - 1;
  std::size_t slot = hashOf(mask) & last;
  while (slot_[slot] != 0 && maskAt<Bits>(pattern_, slot_[slot]).word != mask.word) {
    slot = (slot + 1) & last;
  }
  return slot;
}

template <int Bits>
const PatternSphere& PatternSpheres::of(const NodeMask<Bits>& mask) const noexcept {
  if (sphere_.size() == 1) return sphere_[0];
  if constexpr (Bits == 1) {
    return sphere_[mask.word[0] & 255U];
  } else {
    return sphere_[slot_[slotOf(mask)]];
  }
}

template const PatternSphere& PatternSpheres::of<1>(const NodeMask<1>&) const noexcept;
template const PatternSphere& PatternSpheres::of<2>(const NodeMask<2>&) const noexcept;
template const PatternSphere& PatternSpheres::of<3>(const NodeMask<3>&) const noexcept;

}  // namespace palpate
