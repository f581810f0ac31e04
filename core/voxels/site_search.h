#pragma once
/// How far a box of space is from the contact region, as an affine lower bound.
///
/// A list of sites, in groups that each have a box of their own: a search looks at the boxes first
/// and at the sites of the few groups that may hold the nearest one. Lengths in the smallest
/// spacing, one frame for all. For the builders; not for the loops.

#include <array>
#include <cstddef>
#include <vector>

namespace palpate {

using Float3 = std::array<float, 3>;

/// N near one place lies in [lo, hi] and, unless n is 0 and h large, below n·p <= h.
struct SiteBounds {
  Float3 lo{}, hi{}, n{};
  float h = kNoPlane;
  static constexpr float kNoPlane = 1e9f;
};

class SiteSearch {
 public:
  static constexpr float kNothing = 1e9f;  ///< The bound where there is no site.

  void clear();
  void beginGroup();
  void add(const SiteBounds& site);
  void endGroup();
  [[nodiscard]] bool empty() const noexcept { return groupFirst_.empty(); }

  /// The largest b found such that b + g·(u − c) is at most the distance from u to any site, for
  /// every u with |u − c| <= half along each axis. |g| <= 1.
  [[nodiscard]] float bound(const Float3& c, const Float3& g, const Float3& half);

 private:
  static constexpr std::size_t kColumns = 10;  // lo, hi, n, h
  void evaluate(const std::vector<float> (&columns)[kColumns], std::size_t first, std::size_t count,
                const Float3& c, const Float3& g, const Float3& half, float* value) const;

  std::vector<float> site_[kColumns], group_[kColumns];
  std::vector<std::size_t> groupFirst_, groupEnd_;
  std::vector<float> groupValue_, siteValue_;
};

}  // namespace palpate
