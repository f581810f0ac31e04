#include "tests/stability/matrix_report.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

namespace palpate::stability {
namespace {

namespace fs = std::filesystem;

fs::path folder() {
  const char* asked = std::getenv("PALPATE_STABILITY_OUT");
  const fs::path out = asked != nullptr ? asked : "stability-results";
  fs::create_directories(out);
  return out;
}

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

void writeTable(const fs::path& file, const std::vector<Row>& rows) {
  std::ofstream out(file);
  out << "case,x,y,verdict,why,lowest_energy_uJ,largest_force_N,largest_rise_N_per_tick,"
         "ripple_N_per_tick,deepest_mm\n";
  for (const Row& row : rows) {
    const Judged& j = row.judged;
    out << '"' << row.name << "\"," << number(row.x) << ',' << number(row.y) << ','
        << name(j.verdict) << ",\"" << j.why << "\"," << number(1e6 * j.lowestEnergy) << ','
        << number(j.largestForce) << ',' << number(j.largestRise) << ',' << number(j.roughness)
        << ',' << number(1e3 * j.deepest) << '\n';
  }
}

const char* colourOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::Pass:
      return "#009E73";
    case Verdict::Guarded:
      return "#E69F00";
    case Verdict::Exception:
      return "#D55E00";
  }
  return "#000000";
}

/// Cells of a grid of all the values that occur, coloured by the worst verdict there.
class Map {
 public:
  Map(const MapAxes& axes, const std::vector<Row>& rows) : axes_(axes), rows_(rows) {
    std::set<double> xs, ys;
    for (const Row& row : rows) {
      xs.insert(row.x);
      ys.insert(row.y);
    }
    x_.assign(xs.begin(), xs.end());
    y_.assign(ys.begin(), ys.end());
  }

  [[nodiscard]] std::string svg() const {
    const double width = kLeft + kCell * static_cast<double>(x_.size()) + 24.0;
    const double bottom = kTop + kRow * static_cast<double>(y_.size());
    std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + number(width) +
                      "\" height=\"" + number(bottom + 64.0) +
                      "\" font-family=\"Inter, DejaVu Sans, sans-serif\" font-size=\"13\">\n"
                      "<title>" +
                      axes_.title +
                      "</title>\n"
                      "<rect width=\"100%\" height=\"100%\" fill=\"#F4F6F8\"/>\n";
    out += text(16, 26, "start", axes_.title, " font-size=\"17\" font-weight=\"600\"");
    double at = 16.0;
    for (const Verdict v : {Verdict::Pass, Verdict::Guarded, Verdict::Exception}) {
      out += "<rect x=\"" + number(at) + "\" y=\"42\" width=\"14\" height=\"14\" fill=\"" +
             colourOf(v) + "\"/>\n" + text(at + 20, 54, "start", name(v));
      at += 100.0;
    }
    for (std::size_t j = 0; j < y_.size(); ++j) {
      // The largest on top.
      const double y = kTop + kRow * static_cast<double>(y_.size() - 1 - j);
      out += text(kLeft - 8, y + 22, "end", number(y_[j]));
      for (std::size_t i = 0; i < x_.size(); ++i) {
        out += cell(kLeft + kCell * static_cast<double>(i), y, x_[i], y_[j]);
      }
    }
    for (std::size_t i = 0; i < x_.size(); ++i) {
      out += text(kLeft + kCell * (static_cast<double>(i) + 0.5), bottom + 18, "middle",
                  number(x_[i]));
    }
    out +=
        text(kLeft + 0.5 * kCell * static_cast<double>(x_.size()), bottom + 44, "middle", axes_.x);
    out += text(16, kTop - 10, "start", axes_.y);
    return out + "</svg>\n";
  }

 private:
  static constexpr double kLeft = 84.0, kTop = 100.0, kCell = 72.0, kRow = 34.0;

  static std::string text(double x, double y, const char* anchor, const std::string& words,
                          const std::string& more = "") {
    return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor +
           "\" fill=\"#1B1F26\"" + more + ">" + words + "</text>\n";
  }

  [[nodiscard]] std::string cell(double left, double top, double x, double y) const {
    const Row* worst = nullptr;
    std::size_t runs = 0;
    for (const Row& row : rows_) {
      if (row.x != x || row.y != y) continue;
      ++runs;
      if (worst == nullptr || row.judged.verdict > worst->judged.verdict) worst = &row;
    }
    if (worst == nullptr) return "";
    const Judged& j = worst->judged;
    return "<rect x=\"" + number(left + 1) + "\" y=\"" + number(top + 1) + "\" width=\"" +
           number(kCell - 2) + "\" height=\"" + number(kRow - 2) + "\" fill=\"" +
           colourOf(j.verdict) + "\"><title>" + std::to_string(runs) +
           " runs; worst: " + worst->name + (j.why.empty() ? "" : ": " + j.why) +
           "</title></rect>\n";
  }

  const MapAxes& axes_;
  const std::vector<Row>& rows_;
  std::vector<double> x_, y_;
};

}  // namespace

void report(const std::string& family, const std::vector<Row>& rows, const MapAxes* axes) {
  const fs::path out = folder();
  const std::string stem = family + (kWhole ? "" : "-part");
  writeTable(out / (stem + ".csv"), rows);
  if (axes != nullptr) std::ofstream(out / (stem + ".svg")) << Map(*axes, rows).svg();
  std::array<int, 3> counts{};
  double lowest = 0.0;
  for (const Row& row : rows) {
    ++counts.at(static_cast<std::size_t>(row.judged.verdict));
    lowest = std::min(lowest, row.judged.lowestEnergy);
  }
  std::printf("%s: %zu runs, %d pass, %d guarded, %d exceptions; lowest energy %.1f uJ\n",
              family.c_str(), rows.size(), counts[0], counts[1], counts[2], 1e6 * lowest);
}

}  // namespace palpate::stability
