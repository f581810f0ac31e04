#pragma once
/// Where the contact region is, cell by cell, and how far a block of cells is from it.
///
/// The contact region N is where the trilinear value is negative. Outside N, its nearest point
/// lies in a mixed cell, one with corners of both kinds. A *site* bounds N in one mixed cell by a
/// box and by a plane; together they give lower bounds of the distance to N that hold everywhere
/// in a block, not only at samples. All lengths in units of the smallest spacing.

#include <cstddef>
#include <vector>

namespace palpate::bench {

/// N within one cell lies in [lo, hi] and below the plane n·s <= h.
struct Site {
  float lo[3], hi[3], n[3], h;
};

/// The site of the cell at `cell` (in voxels) with these eight corner values (x fastest) and edges
/// `axis`. False where N does not reach into the cell. Values below `slack` count as negative: what
/// the query computes from coded depths may differ by that much.
[[nodiscard]] bool siteOfCell(const float corner[8], const int cell[3], const float axis[3],
                              float slack, Site& site);

/// Sites side by side, for the search.
class SiteList {
 public:
  void clear();
  void add(const Site& s);
  [[nodiscard]] std::size_t size() const { return column_[0].size(); }
  /// The largest b found for which b + g·(u - c) is no more than the distance from u to any of the
  /// sites, for every u with |u - c| <= half along each axis. 1e9 without sites. |g| <= 1.
  [[nodiscard]] float bound(const float c[3], const float g[3], const float half[3]) const;

 private:
  std::vector<float> column_[10];  // lo, hi, n, h
};

}  // namespace palpate::bench
