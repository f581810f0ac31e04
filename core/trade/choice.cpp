#include "core/trade/choice.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/base/short_number.h"

namespace palpate {
namespace {

/// The better the lower.
auto rankOf(const TradePoint& point) {
  return std::tuple(point.errors.force_N.p95, point.errors.depth_mm.p95);
}

bool beats(const TradePoint& a, const TradePoint& b) {
  const double aError = a.errors.force_N.p95, bError = b.errors.force_N.p95;
  const double aTime = a.cost.p99_us, bTime = b.cost.p99_us;
  return aError <= bError && aTime <= bTime && (aError < bError || aTime < bTime);
}

}  // namespace

void markFront(std::vector<TradePoint>& points) {
  for (TradePoint& point : points) {
    point.onFront =
        point.offered && std::none_of(points.begin(), points.end(), [&](const TradePoint& other) {
          return other.offered && beats(other, point);
        });
  }
}

Result<TradePoint> chooseSetting(const std::vector<TradePoint>& points, double deadline_s,
                                 double headroom) {
  if (!(deadline_s > 0.0) || !std::isfinite(deadline_s)) {
    return fail(usageError("A deadline is a time above zero.").inField("deadline"));
  }
  if (!(headroom > 0.0 && headroom <= 1.0)) {
    return fail(usageError("The headroom is the share of the deadline that a step may use.")
                    .inField("headroom")
                    .wants("above 0, at most 1"));
  }
  const double most_us = headroom * deadline_s * 1e6;
  const TradePoint* best = nullptr;
  const TradePoint* fastest = nullptr;
  for (const TradePoint& point : points) {
    if (!point.offered) continue;
    if (fastest == nullptr || point.cost.p999_us < fastest->cost.p999_us) fastest = &point;
    if (point.cost.p999_us > most_us) continue;
    if (best == nullptr || rankOf(point) < rankOf(*best)) best = &point;
  }
  if (best != nullptr) return *best;
  Error error = checkFailed("No measured setting fits the deadline.")
                    .inField("deadline")
                    .wants(formatted("a step of at most %.1f us at p99.9", most_us))
                    .advise("Allow a longer deadline, or a coarser instrument shell.");
  if (fastest != nullptr) {
    error.butFound(formatted("%.1f us, with ", fastest->cost.p999_us) + fastest->name);
  }
  return fail(std::move(error));
}

}  // namespace palpate
