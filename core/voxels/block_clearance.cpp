#include "core/voxels/block_clearance.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace palpate {
namespace {

// Sites farther from a block of 16³ than this are not looked at; at most the edge of such a block,
// which is 16 smallest spacings or more.
constexpr float kWindow = 8.0f;

float gap(float lo, float hi, float blockHi) noexcept {
  return std::max({0.0f, lo - blockHi, -hi});
}

}  // namespace

BlockClearance::BlockClearance(const DepthBricks& bricks, const std::vector<BrickPlan>& plan)
    : bricks_(bricks), plan_(plan) {
  for (std::size_t a = 0; a < 3; ++a) edge_[a] = std::sqrt(bricks.palette.weight()[a]);
}

void BlockClearance::gather(const Block& block, Scratch& scratch) const {
  scratch.sites.clear();
  Block lo;
  Block hi;
  for (std::size_t a = 0; a < 3; ++a) {
    lo[a] = std::max(block[a] - 1, 0);
    hi[a] = std::min(block[a] + 1, bricks_.blocks[a] - 1);
  }
  for (std::int32_t z = lo[2]; z <= hi[2]; ++z) {
    for (std::int32_t y = lo[1]; y <= hi[1]; ++y) {
      for (std::int32_t x = lo[0]; x <= hi[0]; ++x) {
        const BrickPlan& plan = plan_[bricks_.blockAt(x, y, z)];
        const Block step{x - block[0], y - block[1], z - block[2]};
        const RegionSite* site = plan.sites.data();
        std::size_t child = 0;  // among those with bricks of their own
        for (std::uint64_t left = plan.bricks & ~plan.deep; left != 0; left &= left - 1, ++child) {
          const int c = std::countr_zero(left);
          Float3 corner;  // of the child, from the block's
          float d2 = 0;
          for (std::size_t a = 0; a < 3; ++a) {
            corner[a] = edge_[a] * static_cast<float>(step[a] * 16 + (c >> (2 * a) & 3) * 4);
            const float d = gap(corner[a], corner[a] + 4.0f * edge_[a], 16.0f * edge_[a]);
            d2 += d * d;
          }
          if (d2 <= kWindow * kWindow) {
            gatherChild(corner, site, plan.siteCount[child], scratch.sites);
          }
          site += plan.siteCount[child];
        }
      }
    }
  }
}

// The sites of one 4³ block whose corner is there, as one group.
void BlockClearance::gatherChild(const Float3& corner, const RegionSite* site, std::size_t count,
                                 SiteSearch& sites) const {
  sites.beginGroup();
  for (std::size_t i = 0; i < count; ++i) {
    SiteBounds bounds;
    bounds.h = static_cast<float>(site[i].h) / RegionSite::kPlaneSteps;
    for (std::size_t a = 0; a < 3; ++a) {
      const float at = corner[a] + edge_[a] * static_cast<float>(site[i].cell >> (2 * a) & 3);
      bounds.lo[a] = at + edge_[a] * static_cast<float>(site[i].lo[a]) / RegionSite::kBoxSteps;
      bounds.hi[a] = at + edge_[a] * static_cast<float>(site[i].hi[a]) / RegionSite::kBoxSteps;
      bounds.n[a] = static_cast<float>(site[i].n[a]) / RegionSite::kNormalSteps;
      bounds.h += bounds.n[a] * at;
    }
    sites.add(bounds);
  }
  sites.endGroup();
}

Float3 BlockClearance::middleOf(int child) const noexcept {
  Float3 c;
  for (std::size_t a = 0; a < 3; ++a) {
    c[a] = edge_[a] * static_cast<float>((child >> (2 * a) & 3) * 4 + 2);
  }
  return c;
}

// The mean of the sites' normals: the way out of the block.
Float3 BlockClearance::outwardOf(const RegionSite* site, std::size_t count) const noexcept {
  Float3 sum{};
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t a = 0; a < 3; ++a) sum[a] += static_cast<float>(site[i].n[a]);
  }
  const float length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
  for (float& v : sum) v = length > 1.0f ? v / length : 0.0f;
  return sum;
}

// The better of what lattice and sites give for some slopes.
float BlockClearance::boundFor(int child, const Candidate& candidate, SiteSearch& sites,
                               SiteSearch* own) const {
  // Farther than the sites can tell, the lattice alone decides.
  if (candidate.fromLattice >= kWindow) return candidate.fromLattice;
  const Float3 middle = middleOf(child);
  const Float3 half{2.0f * edge_[0], 2.0f * edge_[1], 2.0f * edge_[2]};
  Float3 g;
  float bound = kWindow;  // what is not in the search is at least that far from the block
  for (std::size_t a = 0; a < 3; ++a) {
    g[a] = static_cast<float>(candidate.slopes[a]) / ClearanceWord::kSlopeSteps;
    bound -= half[a] * std::abs(g[a]);
  }
  bound = std::min(bound, sites.bound(middle, g, half));
  if (own != nullptr && !own->empty()) bound = std::min(bound, own->bound(middle, g, half));
  return std::max(bound, candidate.fromLattice);
}

std::uint32_t BlockClearance::blockWord(int child, const LatticeBound& lattice,
                                        Scratch& scratch) const {
  const Candidate level{{}, lattice.level};
  const Candidate sloped{{lattice.slopes[0], lattice.slopes[1], lattice.slopes[2]}, lattice.sloped};
  const float a = boundFor(child, level, scratch.sites, nullptr);
  const float b = boundFor(child, sloped, scratch.sites, nullptr);
  return b > a ? ClearanceWord::encode(sloped.slopes, b, ClearanceWord::kBlockSteps)
               : ClearanceWord::encode(level.slopes, a, ClearanceWord::kBlockSteps);
}

std::uint32_t BlockClearance::brickWord(int child, std::uint64_t fullCells, const RegionSite* site,
                                        std::size_t count, const LatticeBound& lattice,
                                        Scratch& scratch) const {
  if (fullCells == ~std::uint64_t{0}) return ClearanceWord::kNever;
  // A point of a full cell is in the region, though no site bounds it there.
  scratch.own.clear();
  scratch.own.beginGroup();
  const Float3 middle = middleOf(child);
  for (std::uint64_t left = fullCells; left != 0; left &= left - 1) {
    const int cell = std::countr_zero(left);
    SiteBounds box;
    for (std::size_t a = 0; a < 3; ++a) {
      box.lo[a] = middle[a] + edge_[a] * static_cast<float>((cell >> (2 * a) & 3) - 2);
      box.hi[a] = box.lo[a] + edge_[a];
    }
    scratch.own.add(box);
  }
  scratch.own.endGroup();
  float best = LatticeBound::kNone;
  std::uint32_t word = ClearanceWord::kNever;
  for (const Candidate& candidate :
       {Candidate{}, Candidate{{lattice.slopes[0], lattice.slopes[1], lattice.slopes[2]}},
        Candidate{ClearanceWord::slopesOf(outwardOf(site, count))}}) {
    const float bound = boundFor(child, candidate, scratch.sites, &scratch.own);
    if (bound <= best) continue;
    best = bound;
    word = ClearanceWord::encode(candidate.slopes, bound, ClearanceWord::kBrickSteps);
  }
  return word;
}

}  // namespace palpate
