#pragma once
/// The trade as pictures (SVG): the front, and what each option is worth.

#include <string>
#include <vector>

#include "app/trade_report.h"

namespace palpate {

/// The points on the front, the fastest first.
[[nodiscard]] std::vector<TradePoint> frontOf(const std::vector<TradePoint>& points);
/// p99 step time across (logarithmic), p95 force error up; the front as a line.
[[nodiscard]] std::string frontSvg(const TradeReport& report);
/// A row for each single change: its force error and its step time beside the default's.
[[nodiscard]] std::string optionsSvg(const TradeReport& report);

}  // namespace palpate
