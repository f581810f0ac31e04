#include "app/trade_plots.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/text_table.h"

namespace palpate {
namespace {

constexpr const char* kInk = "#1B1F26";
constexpr const char* kQuiet = "#5B6675";
constexpr const char* kRule = "#D5DAE1";
constexpr const char* kAccent = "#187A71";
constexpr const char* kGrey = "#9AA4B2";
constexpr const char* kWarm = "#C2571A";

/// A setting's name is ours, but a text stays well-formed whatever it holds.
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

std::string textAt(double x, double y, const std::string& anchor, const std::string& text,
                   const char* fill = kInk) {
  return "<text x=\"" + decimal(x, 1) + "\" y=\"" + decimal(y, 1) + "\" text-anchor=\"" + anchor +
         "\" fill=\"" + fill + "\">" + xmlText(text) + "</text>\n";
}

std::string lineAt(double x1, double y1, double x2, double y2, const std::string& style) {
  return "<line x1=\"" + decimal(x1, 1) + "\" y1=\"" + decimal(y1, 1) + "\" x2=\"" +
         decimal(x2, 1) + "\" y2=\"" + decimal(y2, 1) + "\" " + style + "/>\n";
}

std::string ruled(const char* colour) {
  return std::string("stroke=\"") + colour + "\"";
}

std::string page(double width, double height, const std::string& content) {
  const std::string w = decimal(width, 0), h = decimal(height, 0);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + w + "\" height=\"" + h +
         "\" viewBox=\"0 0 " + w + " " + h +
         "\" font-family=\"Inter, sans-serif\" font-size=\"13\">\n<rect width=\"" + w +
         "\" height=\"" + h + "\" fill=\"#FFFFFF\"/>\n" + content + "</svg>\n";
}

/// The settings that are drawn: what a scene can declare. The reference has no error and its time
/// is another world's.
std::vector<const TradePoint*> drawn(const TradeReport& report) {
  std::vector<const TradePoint*> points;
  for (const TradePoint& point : report.sweep.points) {
    if (point.offered) points.push_back(&point);
  }
  return points;
}

/// Data to picture: time on a logarithmic axis, error on a linear one from zero.
struct Axes {
  double timeLow = 1.0, timeHigh = 10.0, errorHigh = 1.0;
  static constexpr double kLeft = 70, kRight = 760, kTop = 56, kBottom = 430;

  explicit Axes(const TradeReport& report) {
    timeLow = timeHigh = report.deadline_s * report.headroom * 1e6;
    double error = 0.0;
    for (const TradePoint* point : drawn(report)) {
      timeLow = std::min(timeLow, std::max(point->cost.p99_us, 0.1));
      timeHigh = std::max(timeHigh, point->cost.p99_us);
      error = std::max(error, point->errors.force_N.p95);
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

/// The least of 1, 2, 5, 10 ... that leaves at most five lines below `high`.
double roundStep(double high) {
  const double least = high / 5.0;
  const double decade = std::pow(10.0, std::floor(std::log10(least)));
  for (const double times : {1.0, 2.0, 5.0}) {
    if (times * decade >= least) return times * decade;
  }
  return 10.0 * decade;
}

std::string gridOf(const Axes& axes, double limit_us) {
  std::string svg;
  for (double decade = 0.1; decade < axes.timeHigh; decade *= 10.0) {
    if (decade < axes.timeLow) continue;
    svg += lineAt(axes.x(decade), Axes::kTop, axes.x(decade), Axes::kBottom, ruled(kRule));
    svg += textAt(axes.x(decade), Axes::kBottom + 18, "middle",
                  decimal(decade, decade < 1.0 ? 1 : 0) + " µs");
  }
  const double step = roundStep(axes.errorHigh);
  const int digits = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  for (int i = 0; i * step <= axes.errorHigh; ++i) {
    const double error = i * step;
    svg += lineAt(Axes::kLeft, axes.y(error), Axes::kRight, axes.y(error), ruled(kRule));
    svg += textAt(Axes::kLeft - 8, axes.y(error) + 4, "end", decimal(error, digits) + " N");
  }
  svg += lineAt(axes.x(limit_us), Axes::kTop, axes.x(limit_us), Axes::kBottom,
                R"(stroke="#E0A93B" stroke-width="2" stroke-dasharray="6 4")");
  svg += textAt(axes.x(limit_us) - 6, Axes::kTop + 14, "end", "limit of a step", kQuiet);
  svg += textAt((Axes::kLeft + Axes::kRight) / 2, Axes::kBottom + 40, "middle",
                "time of a step, 99th percentile", kQuiet);
  return svg + textAt(Axes::kLeft, Axes::kTop - 14, "start", "error of the force, 95th percentile",
                      kQuiet);
}

double ratio(double value, double own) {
  return own > 0.0 ? value / own : 1.0;
}

/// Half a row: a bar from the default's value to this one's, on an axis from 0.
std::string bar(double left, double width, double y, double value, double own, double most,
                const std::string& text) {
  const auto at = [&](double v) { return left + width * std::min(v / most, 1.0); };
  const double from = std::min(at(own), at(value)), to = std::max(at(own), at(value));
  std::string svg = lineAt(at(own), y - 8, at(own), y + 8, ruled(kGrey));
  svg += "<rect x=\"" + decimal(from, 1) + "\" y=\"" + decimal(y - 5, 1) + "\" width=\"" +
         decimal(std::max(to - from, 1.0), 1) + "\" height=\"10\" fill=\"" +
         (value > own ? kWarm : kAccent) + "\"/>\n";
  return svg + textAt(left + width + 8, y + 4, "start", text, kQuiet);
}

}  // namespace

std::vector<TradePoint> frontOf(const std::vector<TradePoint>& points) {
  std::vector<TradePoint> front;
  for (const TradePoint& point : points) {
    if (point.onFront) front.push_back(point);
  }
  std::sort(front.begin(), front.end(),
            [](const auto& a, const auto& b) { return a.cost.p99_us < b.cost.p99_us; });
  return front;
}

std::string frontSvg(const TradeReport& report) {
  const Axes axes(report);
  std::string svg = textAt(Axes::kLeft, 22, "start", "What speed costs: every setting measured");
  svg += gridOf(axes, report.deadline_s * report.headroom * 1e6);
  std::string line;
  for (const TradePoint& point : frontOf(report.sweep.points)) {
    line += decimal(axes.x(point.cost.p99_us), 1) + "," +
            decimal(axes.y(point.errors.force_N.p95), 1) + " ";
  }
  svg += "<polyline points=\"" + line + "\" fill=\"none\" stroke=\"" + kAccent +
         "\" stroke-width=\"2\"/>\n";
  std::vector<const TradePoint*> points = drawn(report);  // what matters is drawn last
  const auto isChosen = [&report](const TradePoint* point) {
    return report.chosen && report.chosen->name == point->name;
  };
  std::stable_sort(points.begin(), points.end(), [&](const TradePoint* a, const TradePoint* b) {
    return std::pair(isChosen(a), a->onFront) < std::pair(isChosen(b), b->onFront);
  });
  for (const TradePoint* point : points) {
    const bool chosen = isChosen(point);
    const bool own = point->name == "default";
    const double x = axes.x(point->cost.p99_us), y = axes.y(point->errors.force_N.p95);
    svg += "<circle cx=\"" + decimal(x, 1) + "\" cy=\"" + decimal(y, 1) + "\" r=\"" +
           (chosen || own ? "7" : "4") + "\" fill=\"" +
           (chosen || point->onFront ? kAccent : kGrey) + "\"><title>" + xmlText(point->name) +
           "</title></circle>\n";
    if (own) svg += textAt(x + 10, y - 8, "start", chosen ? "default, chosen" : "default");
    if (chosen && !own) svg += textAt(x + 10, y - 26, "start", "chosen: " + point->name);
  }
  return page(800, 490, svg);
}

std::string optionsSvg(const TradeReport& report) {
  constexpr double kLeft = 190, kBar = 200, kGap = 90, kRow = 22, kTop = 78;
  const auto own = std::find_if(report.sweep.points.begin(), report.sweep.points.end(),
                                [](const TradePoint& p) { return p.name == "default"; });
  std::vector<const TradePoint*> rows;
  for (const TradePoint& point : report.sweep.points) {
    if (!point.option.empty()) rows.push_back(&point);
  }
  if (own == report.sweep.points.end() || rows.empty()) {
    return page(800, 100, textAt(20, 40, "start", "No option was changed by itself."));
  }
  const double ownError = own->errors.force_N.p95, ownTime = own->cost.p99_us;
  double mostError = 1e-6;
  for (const TradePoint* row : rows) mostError = std::max(mostError, row->errors.force_N.p95);
  constexpr double kMostRatio = 4.0;  // longer bars end there; the number tells
  const double right = kLeft + kBar + kGap;
  std::string svg = textAt(20, 24, "start", "What each option is worth, changed by itself");
  svg += textAt(kLeft, 50, "start", "error of the force, p95", kQuiet);
  svg += textAt(right, 50, "start", "time of a step, p99, beside the default's", kQuiet);
  svg += textAt(kLeft, 66, "start", "default " + decimal(ownError, 3) + " N", kQuiet);
  svg += textAt(right, 66, "start", "default " + decimal(ownTime, 1) + " µs", kQuiet);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const TradePoint& row = *rows[i];
    const double y = kTop + kRow * (static_cast<double>(i) + 0.5);
    const double times = ratio(row.cost.p99_us, ownTime);
    svg += textAt(kLeft - 10, y + 4, "end", row.name);
    svg += bar(kLeft, kBar, y, row.errors.force_N.p95, ownError, mostError,
               decimal(row.errors.force_N.p95, 3) + " N");
    svg += bar(right, kBar, y, times, 1.0, kMostRatio, "× " + decimal(times, 2));
  }
  return page(800, kTop + kRow * static_cast<double>(rows.size()) + 20, svg);
}

}  // namespace palpate
