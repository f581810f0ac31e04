#pragma once
/// A measured trade, remembered: which settings a scene can have, what each errs and costs on this
/// machine, and which was chosen.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/simulation/prepared_scene.h"
#include "core/trade/tradeoff.h"

namespace palpate {

struct TradeRow {
  std::string name;                  ///< Of changes of the scene's own setting; "default": none.
  double depth_mm = 0, force_N = 0;  ///< As promised.
  double p99_us = 0, p999_us = 0;    ///< As measured: what the choice went by.
  bool onFront = false;
};

struct TradeMemo {
  std::vector<TradeRow> rows;  ///< The fastest first.
  std::string chosen = "default";
};

/// The offered points of a sweep.
[[nodiscard]] TradeMemo memoOf(const TradeSweep& sweep, const std::string& chosen);

/// What the numbers hold for: this scene at its own setting, this device, this machine, this
/// version. Another key: measure again. A pass over all voxels: not for the main thread.
[[nodiscard]] std::string tradeKey(const PreparedScene& scene, const SimulationSetting& own,
                                   const std::string& device);

/// CASE/trade.cache.json, which may be deleted at any time. Nothing where there is none, it is of
/// another key, or it cannot be read.
[[nodiscard]] std::optional<TradeMemo> readTradeMemo(const std::filesystem::path& caseFolder,
                                                     const std::string& key);
[[nodiscard]] Result<void> writeTradeMemo(const std::filesystem::path& caseFolder,
                                          const std::string& key, const TradeMemo& memo);

/// Measures in seconds, chooses under the deadline of the scene's own step.
/// @param declared  at the case's own setting.
[[nodiscard]] Result<TradeMemo> measureTradeMemo(const PreparedScene& declared,
                                                 const DeviceInfo& device,
                                                 const Progress& progress);

/// The scene with what a governor may step down to from its setting; without levels where nothing
/// of the memo is a step down.
[[nodiscard]] std::shared_ptr<const PreparedScene> governed(
    const std::shared_ptr<const PreparedScene>& scene, const SimulationSetting& own,
    const TradeMemo& memo);

/// Of a step's time, what it may take; the rest is the system's and the servo's.
inline constexpr double kTradeHeadroom = 0.5;

/// The scene's own setting with the changes that a row names; nothing for a name that is none.
[[nodiscard]] std::optional<SimulationSetting> settingOfRow(const std::string& name,
                                                            const SimulationSetting& own,
                                                            const Instrument& instrument);

}  // namespace palpate
