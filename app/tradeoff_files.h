#pragma once
/// What `tradeoff` shows and writes: the table, the JSON, and the front as a picture.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/trade/tradeoff.h"

namespace palpate {

struct TradeoffResult {
  std::vector<TradePoint> points;
  std::optional<TradePoint> chosen;
  std::uint64_t seed = 0;
  double deadline_s = 1e-3, headroom = 0.5;
};

/// {seed, front[], points[], chosen{} or null}
[[nodiscard]] nlohmann::ordered_json tradeoffJson(const TradeoffResult& result);
[[nodiscard]] std::string tradeoffText(const TradeoffResult& result);
[[nodiscard]] std::string tradeoffCsv(const TradeoffResult& result);
/// p99.9 step time across (logarithmic), p95 force error up; the front as a line.
[[nodiscard]] std::string tradeoffSvg(const TradeoffResult& result);
/// tradeoff.csv, tradeoff.json and tradeoff.svg in `folder` (made if need be): each whole or not at
/// all.
[[nodiscard]] Result<void> writeTradeoffFiles(const TradeoffResult& result,
                                              const std::filesystem::path& folder);

}  // namespace palpate
