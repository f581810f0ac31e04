#pragma once
/// What `tradeoff` says and writes: the table, the JSON, the CSV, the pictures.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/trade/tradeoff.h"

namespace palpate {

struct TradeReport {
  TradeSweep sweep;
  std::optional<TradePoint> chosen;
  std::optional<TradePoint> checked;  ///< The chosen setting over motions that the sweep had not.
  std::uint64_t checkedSeed = 0;
  double deadline_s = 1e-3, headroom = 0.5;
};

/// Within a tenth (and 0.002 N) of what was promised: error of the force, and time of a step.
[[nodiscard]] bool promiseHeld(const TradePoint& chosen, const TradePoint& checked);

/// {seed, reference, trajectories[], front[], points[], growth[], chosen{} or null}
[[nodiscard]] nlohmann::ordered_json tradeJson(const TradeReport& report);
[[nodiscard]] std::string tradeText(const TradeReport& report);
/// A row a setting.
[[nodiscard]] std::string tradeCsv(const TradeReport& report);
/// tradeoff.csv, tradeoff.json, and front and options as .svg and .png in `folder` (made if need
/// be): each file whole or not at all.
[[nodiscard]] Result<void> writeTradeFiles(const TradeReport& report,
                                           const std::filesystem::path& folder);

}  // namespace palpate
