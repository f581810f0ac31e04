#include "app/trade_report.h"

#include <algorithm>
#include <cmath>

#include "app/setting_report.h"
#include "app/svg_picture.h"
#include "app/text_table.h"
#include "app/trade_plots.h"
#include "core/base/whole_file.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

ordered_json spreadJson(const Spread& spread) {
  return {{"median", spread.median}, {"p95", spread.p95}, {"worst", spread.worst}};
}

ordered_json errorsJson(const TradeErrors& errors) {
  return {{"force_N", spreadJson(errors.force_N)},
          {"torque_Nmm", spreadJson(errors.torque_Nmm)},
          {"depth_mm", spreadJson(errors.depth_mm)},
          {"normal_deg", spreadJson(errors.normal_deg)},
          {"ripple_N", spreadJson(errors.ripple_N)},
          {"jump_N_per_ms", spreadJson(errors.jump_N_per_ms)},
          {"rest_mm", spreadJson(errors.rest_mm)},
          {"onset_ms", spreadJson(errors.onset_ms)}};
}

ordered_json stepJson(const TradeCost& cost) {
  return timingJson({cost.p50_us, cost.p99_us, cost.p999_us, cost.worst_us});
}

ordered_json pointJson(const TradePoint& point) {
  ordered_json json;
  json["name"] = point.name;
  json["option"] = point.option;
  json["value"] = point.value;
  json["force_error_p95_N"] = point.errors.force_N.p95;
  json["depth_error_p95_mm"] = point.errors.depth_mm.p95;
  json["normal_error_p95_deg"] = point.errors.normal_deg.p95;
  json["contacts_missed"] = point.errors.missed;
  json["contacts_extra"] = point.errors.extra;
  json["contacts_reference"] = point.errors.reference;
  json["errors"] = errorsJson(point.errors);
  json["step_us"] = stepJson(point.cost);
  json["tests"] = {{"p50", point.cost.testsP50}, {"p99", point.cost.testsP99}};
  json["shell_points"] = point.cost.shellPoints;
  json["bytes"] = point.cost.bytes;
  json["build_ms"] = point.cost.build_ms;
  json["promise"] = {{"force_error_p95_N", point.promise.force_N},
                     {"depth_error_p95_mm", point.promise.depth_mm},
                     {"step_p999_us", point.promise.p999_us}};
  json["motions_left_out"] = point.leftOut;
  json["on_front"] = point.onFront;
  json["offered"] = point.offered;
  json["setting"] = settingJson(point.setting.simulation);
  json["setting"]["voxels_joined"] = point.setting.coarsening;
  json["setting"]["double_precision"] = point.setting.doublePrecision;
  return json;
}

ordered_json growthJson(const Growth& growth) {
  const auto number = [](double value) {
    return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
  };
  return {{"what", growth.what},
          {"over", growth.over},
          {"exponent", number(growth.exponent)},
          {"confidence_95", {number(growth.low), number(growth.high)}},
          {"points", growth.points}};
}

/// A setting's name is ours, but a CSV cell stays well-formed whatever it holds.
std::string csvCell(const std::string& text) {
  std::string cell(1, '"');
  for (const char c : text) cell.append(c == '"' ? 2 : 1, c);
  cell += '"';
  return cell;
}

std::string leftOutText(const TradeReport& report) {
  const auto& names = report.sweep.leftOut;
  if (names.empty()) return {};
  std::string text = std::to_string(names.size()) + (names.size() == 1 ? " motion" : " motions");
  text +=
      " left out, on which the reference does not settle (wedged between walls, or in through "
      "the scan's edge)";
  for (std::size_t i = 0; i < names.size(); ++i) text.append(i == 0 ? ": " : ", ").append(names[i]);
  return text + "\n";
}

std::string growthText(const TradeSweep& sweep) {
  if (sweep.growth.empty()) return {};
  TextTable table({"grows as", "power of", "exponent", "95 % confidence", "points"});
  for (const Growth& g : sweep.growth) {
    table.add({g.what, g.over, decimal(g.exponent, 2),
               decimal(g.low, 2) + " to " + decimal(g.high, 2), std::to_string(g.points)});
  }
  return std::string("\n").append(table.text());
}

std::string choiceText(const TradeReport& report) {
  if (!report.chosen) return {};
  const TradePoint& chosen = *report.chosen;
  std::string text = "\nChosen for " + decimal(report.deadline_s * 1e3, 3) + " ms with headroom " +
                     decimal(report.headroom, 2) + ": " + chosen.name + " (" +
                     decimal(chosen.promise.depth_mm, 2) + " mm, " +
                     decimal(chosen.promise.force_N, 2) + " N, " +
                     decimal(chosen.promise.p999_us, 0) + " µs promised)\n";
  if (report.checked) {
    text += std::string("Over other motions (seed ") + std::to_string(report.checkedSeed) +
            "): " + decimal(report.checked->errors.depth_mm.p95, 2) + " mm, " +
            decimal(report.checked->errors.force_N.p95, 2) + " N, " +
            decimal(report.checked->cost.p999_us, 0) + " µs: the promise " +
            (promiseHeld(chosen, *report.checked) ? "holds" : "does NOT hold") + " within 10 %\n";
  }
  return text;
}

}  // namespace

bool promiseHeld(const TradePoint& chosen, const TradePoint& checked) {
  constexpr double kHand_N = 0.002;
  return checked.errors.force_N.p95 <= 1.1 * chosen.promise.force_N + kHand_N &&
         checked.cost.p999_us <= 1.1 * chosen.promise.p999_us;
}

ordered_json tradeJson(const TradeReport& report) {
  ordered_json json;
  json["seed"] = report.sweep.seed;
  json["reference"] = report.sweep.reference;
  json["trajectories"] = report.sweep.trajectories;
  json["left_out"] = report.sweep.leftOut;
  json["front"] = ordered_json::array();
  for (const TradePoint& point : frontOf(report.sweep.points)) {
    json["front"].push_back(pointJson(point));
  }
  json["points"] = ordered_json::array();
  for (const TradePoint& point : report.sweep.points) json["points"].push_back(pointJson(point));
  json["growth"] = ordered_json::array();
  for (const Growth& growth : report.sweep.growth) json["growth"].push_back(growthJson(growth));
  json["chosen"] = nullptr;
  if (report.chosen) {
    json["chosen"] = pointJson(*report.chosen);
    json["chosen"]["deadline_ms"] = report.deadline_s * 1e3;
    json["chosen"]["headroom"] = report.headroom;
    if (report.checked) {
      json["chosen"]["checked"] = {{"seed", report.checkedSeed},
                                   {"force_error_p95_N", report.checked->errors.force_N.p95},
                                   {"depth_error_p95_mm", report.checked->errors.depth_mm.p95},
                                   {"step_us", stepJson(report.checked->cost)},
                                   {"held", promiseHeld(*report.chosen, *report.checked)}};
    }
  }
  return json;
}

std::string tradeText(const TradeReport& report) {
  TextTable table({"setting", "front", "force p95 N", "torque N mm", "depth mm", "normal °",
                   "missed", "extra", "jump N/ms", "rest mm", "onset ms", "p50 µs", "p99 µs",
                   "p99.9 µs", "memory"});
  for (const TradePoint& point : report.sweep.points) {
    const TradeErrors& e = point.errors;
    table.add({point.name, point.onFront ? "*" : "", decimal(e.force_N.p95, 3),
               decimal(e.torque_Nmm.p95, 2), decimal(e.depth_mm.p95, 3),
               decimal(e.normal_deg.p95, 1), std::to_string(e.missed), std::to_string(e.extra),
               decimal(e.jump_N_per_ms.p95, 3), decimal(e.rest_mm.p95, 3),
               decimal(e.onset_ms.p95, 1), decimal(point.cost.p50_us, 1),
               decimal(point.cost.p99_us, 1), decimal(point.cost.p999_us, 1),
               byteSize(point.cost.bytes)});
  }
  return "Errors against " + report.sweep.reference + ":\n" + table.text() + leftOutText(report) +
         growthText(report.sweep) + choiceText(report);
}

std::string tradeCsv(const TradeReport& report) {
  std::string csv = "name,option,value,on_front,offered";
  const char* const spreads[] = {"force_N",  "torque_Nmm",    "depth_mm", "normal_deg",
                                 "ripple_N", "jump_N_per_ms", "rest_mm",  "onset_ms"};
  for (const char* name : spreads) {
    for (const char* part : {"median", "p95", "worst"}) {
      csv += std::string(",") + name + "_" + part;
    }
  }
  csv +=
      ",contacts_missed,contacts_extra,contacts_reference,step_p50_us,step_p99_us,step_p999_us,"
      "step_worst_us,tests_p50,tests_p99,shell_points,bytes,build_ms\n";
  for (const TradePoint& point : report.sweep.points) {
    const TradeErrors& e = point.errors;
    const TradeCost& c = point.cost;
    csv += csvCell(point.name);
    for (const std::string& text : {point.option, point.value})
      csv.append(",").append(csvCell(text));
    csv.append(point.onFront ? ",1" : ",0").append(point.offered ? ",1" : ",0");
    for (const Spread& s : {e.force_N, e.torque_Nmm, e.depth_mm, e.normal_deg, e.ripple_N,
                            e.jump_N_per_ms, e.rest_mm, e.onset_ms}) {
      for (const double value : {s.median, s.p95, s.worst}) {
        csv.append(",").append(decimal(value, 6));
      }
    }
    for (const std::uint64_t count : {e.missed, e.extra, e.reference}) {
      csv.append(",").append(std::to_string(count));
    }
    for (const double value : {c.p50_us, c.p99_us, c.p999_us, c.worst_us, c.testsP50, c.testsP99}) {
      csv.append(",").append(decimal(value, 3));
    }
    csv.append(",").append(std::to_string(c.shellPoints));
    csv.append(",").append(std::to_string(c.bytes));
    csv.append(",").append(decimal(c.build_ms, 3)).append("\n");
  }
  return csv;
}

Result<void> writeTradeFiles(const TradeReport& report, const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    return fail(machineError("The folder could not be made: " + error.message() + ".")
                    .inFile(folder.string())
                    .advise("Choose another place for --out."));
  }
  std::vector<std::pair<std::string, std::string>> files{
      {"tradeoff.csv", tradeCsv(report)}, {"tradeoff.json", tradeJson(report).dump(2) + "\n"}};
  for (const auto& [name, svg] : {std::pair{std::string("front"), frontSvg(report)},
                                  std::pair{std::string("options"), optionsSvg(report)}}) {
    auto png = pngOfSvg(svg);
    if (!png) return fail(png.error());
    files.emplace_back(name + ".svg", svg);
    files.emplace_back(name + ".png", std::move(*png));
  }
  for (const auto& [name, content] : files) {
    const Result<void> written = writeWholeFile(folder / name, content);
    if (!written) return fail(written.error());
  }
  return {};
}

}  // namespace palpate
