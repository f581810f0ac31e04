#include "app/tradeoff_files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "app/setting_report.h"
#include "app/text_table.h"
#include "core/base/whole_file.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

ordered_json pointJson(const TradePoint& point) {
  ordered_json json;
  json["name"] = point.name;
  json["force_error_p95_N"] = point.forceErrorP95_N;
  json["depth_error_p95_mm"] = point.depthErrorP95_mm;
  json["normal_error_p95_deg"] = point.normalErrorP95_deg;
  json["contacts_missed"] = point.contactsMissed;
  json["contacts_extra"] = point.contactsExtra;
  json["step_us"] = {
      {"p50", point.stepP50_us}, {"p99", point.stepP99_us}, {"p999", point.stepP999_us}};
  json["bytes"] = point.bytes;
  json["on_front"] = point.onFront;
  json["setting"] = settingJson(point.setting);
  return json;
}

/// A setting's name is ours, but a CSV cell and an SVG text stay well-formed whatever it holds.
std::string csvCell(const std::string& text) {
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return cell + "\"";
}

std::string xmlText(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<') {
      out += "&lt;";
    } else if (c == '&') {
      out += "&amp;";
    } else {
      out += c;
    }
  }
  return out;
}

/// Data to picture: time on a logarithmic axis, error on a linear one from zero.
struct Axes {
  double timeLow = 1.0, timeHigh = 10.0, errorHigh = 1.0;
  static constexpr double kLeft = 70, kRight = 730, kTop = 40, kBottom = 420;

  explicit Axes(const TradeoffResult& result) {
    timeLow = timeHigh = result.deadline_s * 1e6;
    double error = 0.0;
    for (const TradePoint& point : result.points) {
      timeLow = std::min(timeLow, std::max(point.stepP999_us, 0.1));
      timeHigh = std::max(timeHigh, point.stepP999_us);
      error = std::max(error, point.forceErrorP95_N);
    }
    timeLow /= 1.5;
    timeHigh *= 1.5;
    errorHigh = error > 0.0 ? error * 1.1 : 1.0;
  }
  [[nodiscard]] double x(double micros) const {
    const double t = std::log(std::max(micros, timeLow) / timeLow) / std::log(timeHigh / timeLow);
    return kLeft + t * (kRight - kLeft);
  }
  [[nodiscard]] double y(double error) const {
    return kBottom - error / errorHigh * (kBottom - kTop);
  }
};

std::string svgText(double x, double y, const std::string& anchor, const std::string& text) {
  return "<text x=\"" + decimal(x, 1) + "\" y=\"" + decimal(y, 1) + "\" text-anchor=\"" + anchor +
         "\">" + xmlText(text) + "</text>\n";
}

std::string svgLine(double x1, double y1, double x2, double y2, const std::string& style) {
  return "<line x1=\"" + decimal(x1, 1) + "\" y1=\"" + decimal(y1, 1) + "\" x2=\"" +
         decimal(x2, 1) + "\" y2=\"" + decimal(y2, 1) + "\" " + style + "/>\n";
}

std::string svgGrid(const Axes& axes, double deadlineMicros) {
  const std::string thin = R"(stroke="#D5DAE1")";
  std::string svg;
  for (double decade = 1.0; decade < axes.timeHigh; decade *= 10.0) {
    if (decade < axes.timeLow) continue;
    svg += svgLine(axes.x(decade), Axes::kTop, axes.x(decade), Axes::kBottom, thin);
    svg += svgText(axes.x(decade), Axes::kBottom + 18, "middle", decimal(decade, 0) + " µs");
  }
  for (int i = 0; i <= 4; ++i) {
    const double error = axes.errorHigh * i / 4.0;
    svg += svgLine(Axes::kLeft, axes.y(error), Axes::kRight, axes.y(error), thin);
    svg += svgText(Axes::kLeft - 8, axes.y(error) + 4, "end", decimal(error, 3) + " N");
  }
  svg += svgLine(axes.x(deadlineMicros), Axes::kTop, axes.x(deadlineMicros), Axes::kBottom,
                 R"(stroke="#E0A93B" stroke-width="2" stroke-dasharray="6 4")");
  svg += svgText(axes.x(deadlineMicros) - 6, Axes::kTop + 12, "end", "limit");
  svg += svgText((Axes::kLeft + Axes::kRight) / 2, Axes::kBottom + 40, "middle",
                 "step time, 99.9th percentile");
  svg += svgText(Axes::kLeft, Axes::kTop - 14, "start", "force error, 95th percentile");
  return svg;
}

std::vector<TradePoint> frontOf(const TradeoffResult& result) {
  std::vector<TradePoint> front;
  for (const TradePoint& point : result.points) {
    if (point.onFront) front.push_back(point);
  }
  std::sort(front.begin(), front.end(),
            [](const auto& a, const auto& b) { return a.stepP999_us < b.stepP999_us; });
  return front;
}

}  // namespace

ordered_json tradeoffJson(const TradeoffResult& result) {
  ordered_json json;
  json["seed"] = result.seed;
  json["front"] = ordered_json::array();
  for (const TradePoint& point : frontOf(result)) json["front"].push_back(pointJson(point));
  json["points"] = ordered_json::array();
  for (const TradePoint& point : result.points) json["points"].push_back(pointJson(point));
  json["chosen"] = nullptr;
  if (result.chosen) {
    json["chosen"] = pointJson(*result.chosen);
    json["chosen"]["deadline_ms"] = result.deadline_s * 1e3;
    json["chosen"]["headroom"] = result.headroom;
  }
  return json;
}

std::string tradeoffText(const TradeoffResult& result) {
  TextTable table({"setting", "front", "force p95 N", "depth p95 mm", "normal p95 °", "p50 µs",
                   "p99 µs", "p99.9 µs", "memory"});
  for (const TradePoint& point : result.points) {
    table.add({point.name, point.onFront ? "*" : "", decimal(point.forceErrorP95_N, 4),
               decimal(point.depthErrorP95_mm, 4), decimal(point.normalErrorP95_deg, 2),
               decimal(point.stepP50_us, 1), decimal(point.stepP99_us, 1),
               decimal(point.stepP999_us, 1), byteSize(point.bytes)});
  }
  std::string text = table.text();
  if (result.chosen) {
    text += "Chosen for " + decimal(result.deadline_s * 1e3, 3) + " ms with headroom " +
            decimal(result.headroom, 2) + ": " + result.chosen->name + "\n";
  }
  return text;
}

std::string tradeoffCsv(const TradeoffResult& result) {
  std::string csv =
      "name,on_front,force_error_p95_N,depth_error_p95_mm,normal_error_p95_deg,contacts_missed,"
      "contacts_extra,step_p50_us,step_p99_us,step_p999_us,bytes\n";
  for (const TradePoint& point : result.points) {
    csv += csvCell(point.name) + "," + (point.onFront ? "1," : "0,");
    for (const double value :
         {point.forceErrorP95_N, point.depthErrorP95_mm, point.normalErrorP95_deg}) {
      csv += decimal(value, 6) + ",";
    }
    csv += std::to_string(point.contactsMissed) + "," + std::to_string(point.contactsExtra) + ",";
    for (const double value : {point.stepP50_us, point.stepP99_us, point.stepP999_us}) {
      csv += decimal(value, 3) + ",";
    }
    csv += std::to_string(point.bytes) + "\n";
  }
  return csv;
}

std::string tradeoffSvg(const TradeoffResult& result) {
  const Axes axes(result);
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 800 480\" "
      "font-family=\"Inter, sans-serif\" font-size=\"13\" fill=\"#1B1F26\">\n"
      "<rect width=\"800\" height=\"480\" fill=\"#FFFFFF\"/>\n";
  svg += svgGrid(axes, result.deadline_s * result.headroom * 1e6);
  std::string line;
  for (const TradePoint& point : frontOf(result)) {
    line += decimal(axes.x(point.stepP999_us), 1) + "," +
            decimal(axes.y(point.forceErrorP95_N), 1) + " ";
  }
  svg +=
      "<polyline points=\"" + line + "\" fill=\"none\" stroke=\"#187A71\" stroke-width=\"2\"/>\n";
  for (const TradePoint& point : result.points) {
    const bool chosen = result.chosen && result.chosen->name == point.name;
    svg += "<circle cx=\"" + decimal(axes.x(point.stepP999_us), 1) + "\" cy=\"" +
           decimal(axes.y(point.forceErrorP95_N), 1) + "\" r=\"" + (chosen ? "7" : "4") +
           "\" fill=\"" + (point.onFront ? "#187A71" : "#9AA4B2") + "\"><title>" +
           xmlText(point.name) + "</title></circle>\n";
  }
  return svg + "</svg>\n";
}

Result<void> writeTradeoffFiles(const TradeoffResult& result, const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    return fail(machineError("The folder could not be made: " + error.message() + ".")
                    .inFile(folder.string())
                    .advise("Choose another place for --out."));
  }
  const std::string json = tradeoffJson(result).dump(2) + "\n";
  const std::pair<const char*, std::string> files[] = {{"tradeoff.csv", tradeoffCsv(result)},
                                                       {"tradeoff.json", json},
                                                       {"tradeoff.svg", tradeoffSvg(result)}};
  for (const auto& [name, content] : files) {
    const Result<void> written = writeWholeFile(folder / name, content);
    if (!written) return fail(written.error());
  }
  return {};
}

}  // namespace palpate
