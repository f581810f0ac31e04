#include "app/trade_memo.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/setting_report.h"
#include "core/base/whole_file.h"
#include "core/simulation/fingerprint.h"
#include "core/trade/choice.h"
#include "core/trade/options.h"

namespace palpate {
namespace {

using nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* kFile = "trade.cache.json";
constexpr int kFormat = 2;

/// The processor's name and how many there are.
std::string machineName() {
  std::ifstream info("/proc/cpuinfo");
  std::string line, name = "unknown processor";
  while (std::getline(info, line)) {
    const std::size_t colon = line.find(": ");
    if (line.rfind("model name", 0) != 0 || colon == std::string::npos) continue;
    name = line.substr(colon + 2);
    break;
  }
  return name + " x " + std::to_string(std::thread::hardware_concurrency());
}

ordered_json rowJson(const TradeRow& row) {
  return {{"name", row.name},     {"depth_mm", row.depth_mm}, {"force_N", row.force_N},
          {"p99_us", row.p99_us}, {"p999_us", row.p999_us},   {"on_front", row.onFront}};
}

TradeRow rowOf(const ordered_json& json) {
  return {json.at("name").get<std::string>(), json.at("depth_mm").get<double>(),
          json.at("force_N").get<double>(),   json.at("p99_us").get<double>(),
          json.at("p999_us").get<double>(),   json.at("on_front").get<bool>()};
}

}  // namespace

TradeMemo memoOf(const TradeSweep& sweep, const std::string& chosen) {
  TradeMemo memo;
  memo.chosen = chosen;
  for (const TradePoint& point : sweep.points) {
    if (!point.offered) continue;
    memo.rows.push_back({point.name, point.promise.depth_mm, point.promise.force_N,
                         point.cost.p99_us, point.cost.p999_us, point.onFront});
  }
  std::stable_sort(memo.rows.begin(), memo.rows.end(),
                   [](const TradeRow& a, const TradeRow& b) { return a.p99_us < b.p99_us; });
  return memo;
}

std::string tradeKey(const PreparedScene& scene, const SimulationSetting& own,
                     const std::string& device) {
  PreparedScene asDeclared = scene;
  asDeclared.scene.setting = own;
  const FeltLabels felt = feltLabelsOf(scene);
  return hashText(fingerprintOf(asDeclared, felt)) + ", " + device + ", " + machineName() + ", " +
         PALPATE_VERSION;
}

std::optional<TradeMemo> readTradeMemo(const fs::path& caseFolder, const std::string& key) {
  std::ifstream file(caseFolder / kFile);
  if (!file) return std::nullopt;
  try {  // a cache: what is wrong with it does not matter, it is measured again
    const auto json = ordered_json::parse(file);
    if (json.at("format").get<int>() != kFormat || json.at("key").get<std::string>() != key) {
      return std::nullopt;
    }
    TradeMemo memo;
    memo.chosen = json.at("chosen").get<std::string>();
    for (const auto& row : json.at("rows")) memo.rows.push_back(rowOf(row));
    return memo;
  } catch (const ordered_json::exception&) {
    return std::nullopt;
  }
}

Result<void> writeTradeMemo(const fs::path& caseFolder, const std::string& key,
                            const TradeMemo& memo) {
  ordered_json json{{"format", kFormat}, {"key", key}, {"chosen", memo.chosen}};
  json["rows"] = ordered_json::array();
  for (const TradeRow& row : memo.rows) json["rows"].push_back(rowJson(row));
  return writeWholeFile(caseFolder / kFile, json.dump(2) + "\n");
}

Result<TradeMemo> measureTradeMemo(const PreparedScene& declared, const DeviceInfo& device,
                                   const Progress& progress) {
  const double period = declared.scene.setting.stepPeriod;
  TradeRequest request;
  request.effort = TradeEffort::Quick;
  request.device = device;
  request.limit_us = 1e6 * kTradeHeadroom * period;
  const auto sweep = sweepTrade(declared, request, progress);
  if (!sweep) return fail(sweep.error());
  const auto chosen = chooseSetting(sweep->points, period, kTradeHeadroom);
  return memoOf(*sweep, chosen ? chosen->name : "default");
}

std::shared_ptr<const PreparedScene> governed(const std::shared_ptr<const PreparedScene>& scene,
                                              const SimulationSetting& own, const TradeMemo& memo) {
  std::vector<MeasuredSetting> measured;
  for (const TradeRow& row : memo.rows) {
    const auto setting = settingOfRow(row.name, own, scene->instrument);
    if (setting) measured.push_back({row.name, *setting, row.p99_us, row.force_N, row.depth_mm});
  }
  const auto with = withLevels(*scene, ladderOf(scene->scene.setting, measured));
  return with ? *with : scene;
}

std::optional<SimulationSetting> settingOfRow(const std::string& name, const SimulationSetting& own,
                                              const Instrument& instrument) {
  const double spacing = own.shellSpacing > 0.0 ? own.shellSpacing : instrument.shellSpacing;
  const auto setting = settingNamed(own, optionsAround(own, spacing), name);
  if (!setting) return std::nullopt;
  return setting->simulation;
}

}  // namespace palpate
