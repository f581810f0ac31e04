#include "core/voxels/site_search.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/voxels/site_search.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace palpate {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Three bounds hold for every u of the box and s of the site, with w = c − (nearest point of the
// site's box to c), d = |w|, m = w / d:
//   |u − s| >= m·(u − s) >= d + m·(u − c)             (s lies behind the plane through that point)
//   |u − s| >= n·(u − s) >= n·u − h                   (s lies below the site's plane)
//   |u − s| >= g·(u − s) >= g·u − max over box of g·s
//   the same with the direction between m and g, which is the better one beside a wide block
// Each, less g·(u − c), is smallest at a corner of the box. `count` is a multiple of 16.
void boundsOfSites(const float* const* column, std::size_t count, const float* c, const float* g,
                   const float* half, float* value) {
  const hn::CappedTag<float, 16> d;
  const auto zero = hn::Zero(d);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    auto d2 = zero;
    decltype(d2) w[3];
    auto along = zero;
    auto plane = hn::Neg(hn::LoadU(d, column[9] + i));
    auto planeTurn = zero;
    auto gc = 0.0f;
    for (int a = 0; a < 3; ++a) {
      const auto centre = hn::Set(d, c[a]);
      const auto lo = hn::LoadU(d, column[a] + i);
      const auto hi = hn::LoadU(d, column[3 + a] + i);
      w[a] = hn::Sub(centre, hn::Min(hn::Max(centre, lo), hi));
      d2 = hn::Add(d2, hn::Mul(w[a], w[a]));
      const auto slope = hn::Set(d, g[a]);
      along = hn::Add(along, hn::Max(hn::Mul(slope, lo), hn::Mul(slope, hi)));
      gc += g[a] * c[a];
      const auto n = hn::LoadU(d, column[6 + a] + i);
      plane = hn::Add(plane, hn::Mul(n, centre));
      planeTurn = hn::Add(planeTurn, hn::Mul(hn::Abs(hn::Sub(n, slope)), hn::Set(d, half[a])));
    }
    const auto dist = hn::Sqrt(d2);
    const auto inverse = hn::Div(hn::Set(d, 1.0f), hn::Max(dist, hn::Set(d, 1e-6f)));
    auto turn = zero;
    for (int a = 0; a < 3; ++a) {
      turn = hn::Add(turn, hn::Mul(hn::Abs(hn::Sub(hn::Mul(w[a], inverse), hn::Set(d, g[a]))),
                                   hn::Set(d, half[a])));
    }
    const auto best = hn::Max(hn::Sub(dist, turn),
                              hn::Max(hn::Sub(plane, planeTurn), hn::Sub(hn::Set(d, gc), along)));
    hn::StoreU(best, d, value + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace palpate
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate {
namespace {

HWY_EXPORT(boundsOfSites);

constexpr std::size_t kWidest = 16;
// Single precision, coordinates of some tens.
constexpr float kRounding = 1e-4f;

void push(std::vector<float> (&columns)[10], const SiteBounds& s) {
  for (std::size_t a = 0; a < 3; ++a) {
    columns[a].push_back(s.lo[a]);
    columns[3 + a].push_back(s.hi[a]);
    columns[6 + a].push_back(s.n[a]);
  }
  columns[9].push_back(s.h);
}

void padByLast(std::vector<float> (&columns)[10]) {
  for (auto& column : columns) {
    while (column.size() % kWidest != 0) column.push_back(column.back());
  }
}

}  // namespace

void SiteSearch::clear() {
  for (auto& column : site_) column.clear();
  for (auto& column : group_) column.clear();
  groupFirst_.clear();
  groupEnd_.clear();
}

void SiteSearch::beginGroup() {
  groupFirst_.push_back(site_[0].size());
}

void SiteSearch::add(const SiteBounds& site) {
  push(site_, site);
}

void SiteSearch::endGroup() {
  const std::size_t first = groupFirst_.back();
  if (first == site_[0].size()) {
    groupFirst_.pop_back();
    return;
  }
  SiteBounds box;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto from = static_cast<std::ptrdiff_t>(first);
    box.lo[a] = *std::min_element(site_[a].begin() + from, site_[a].end());
    box.hi[a] = *std::max_element(site_[3 + a].begin() + from, site_[3 + a].end());
  }
  padByLast(site_);
  groupEnd_.push_back(site_[0].size());
  for (auto& column : group_) column.resize(groupEnd_.size() - 1);
  push(group_, box);
}

void SiteSearch::evaluate(const std::vector<float> (&columns)[kColumns], std::size_t first,
                          std::size_t count, const Float3& c, const Float3& g, const Float3& half,
                          float* value) const {
  const float* column[kColumns];
  for (std::size_t i = 0; i < kColumns; ++i) column[i] = columns[i].data() + first;
  HWY_DYNAMIC_DISPATCH(boundsOfSites)(column, count, c.data(), g.data(), half.data(), value);
}

float SiteSearch::bound(const Float3& c, const Float3& g, const Float3& half) {
  float best = kNothing;
  const std::size_t groups = groupFirst_.size();
  if (groups == 0) return best;
  if (group_[0].size() % kWidest != 0) padByLast(group_);
  groupValue_.resize(group_[0].size());
  evaluate(group_, 0, group_[0].size(), c, g, half, groupValue_.data());
  const auto look = [&](std::size_t group) {
    const std::size_t first = groupFirst_[group];
    const std::size_t count = groupEnd_[group] - first;
    siteValue_.resize(std::max(siteValue_.size(), count));
    evaluate(site_, first, count, c, g, half, siteValue_.data());
    for (std::size_t i = 0; i < count; ++i) best = std::min(best, siteValue_[i]);
  };
  const auto begin = groupValue_.begin();
  const auto likely = static_cast<std::size_t>(
      std::min_element(begin, begin + static_cast<std::ptrdiff_t>(groups)) - begin);
  look(likely);
  for (std::size_t i = 0; i < groups; ++i) {
    if (i != likely && groupValue_[i] < best) look(i);
  }
  return best - kRounding;
}

}  // namespace palpate
#endif
