#pragma once
/// The front of a sweep, and the choice under a deadline.

#include <vector>

#include "core/base/error.h"
#include "core/trade/tradeoff.h"

namespace palpate {

/// Marks the offered points that none beats: no other has at most its p95 force error and at most
/// its p99 step time, and less of one.
void markFront(std::vector<TradePoint>& points);

/// Of the offered settings whose p99.9 fits headroom · deadline the one of lowest p95 force error
/// (ties: depth error, then the first: the scene's own setting); refuses if none fits.
[[nodiscard]] Result<TradePoint> chooseSetting(const std::vector<TradePoint>& points,
                                               double deadline_s, double headroom);

}  // namespace palpate
