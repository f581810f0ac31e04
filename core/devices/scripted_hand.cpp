#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/devices/hand.h"
#include "core/geometry/units.h"

namespace palpate {
namespace {

constexpr std::string_view kHeader = "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,buttons";
constexpr std::size_t kColumns = 9;
constexpr double kUnitTolerance = 0.01;  // hand-written quaternions have few digits

struct Row {
  double t = 0.0;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  std::uint32_t buttons = 0;
};

class ScriptedHand final : public Hand {
 public:
  explicit ScriptedHand(std::vector<Row> rows) noexcept : rows_(std::move(rows)) {}

  HandTarget target(double t, const DeviceSample&, const Wrench&) noexcept override {
    const auto after = std::upper_bound(rows_.begin(), rows_.end(), t,
                                        [](double time, const Row& row) { return time < row.t; });
    if (after == rows_.begin()) return of(rows_.front());
    const Row& a = *(after - 1);
    if (after == rows_.end()) return of(a);
    const double f = (t - a.t) / (after->t - a.t);
    Row between = a;  // buttons hold until the next row
    between.p = a.p + f * (after->p - a.p);
    between.q = a.q.slerp(f, after->q);
    return of(between);
  }

 private:
  static HandTarget of(const Row& row) noexcept {
    HandTarget out;
    out.pose_D = plain(row.p, row.q);
    out.buttons = row.buttons;
    return out;
  }

  std::vector<Row> rows_;  // at least one, times rising
};

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.back() == '\r' || text.back() == ' ')) text.remove_suffix(1);
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  return text;
}

std::string quoted(std::string_view text) {
  std::string out = "\"";
  out += text;
  out += '"';
  return out;
}

/// Nine finite numbers, or false and the text that is none.
bool parseNumbers(std::string_view line, double (&out)[kColumns], std::string& offending) {
  for (std::size_t i = 0; i < kColumns; ++i) {
    const std::size_t comma = line.find(',');
    const bool last = i + 1 == kColumns;
    if ((comma == std::string_view::npos) != last) {
      offending = last ? "more than " + std::to_string(kColumns) + " columns"
                       : std::to_string(i + 1) + " columns";
      return false;
    }
    const std::string_view cell = trimmed(line.substr(0, comma));
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), out[i]);
    if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(out[i])) {
      offending = quoted(cell.substr(0, 40));
      return false;
    }
    if (!last) line.remove_prefix(comma + 1);
  }
  return true;
}

Error refuse(const std::filesystem::path& csv, std::size_t line, const std::string& message) {
  return inputRefused(message).inFile(csv.string()).inField("line " + std::to_string(line));
}

Result<Row> parseRow(const std::filesystem::path& csv, std::size_t number, std::string_view line,
                     const std::vector<Row>& before) {
  double v[kColumns];
  std::string offending;
  if (!parseNumbers(line, v, offending)) {
    return fail(refuse(csv, number, "The hand's path has a row that cannot be read.")
                    .butFound(offending)
                    .wants("nine numbers: " + std::string(kHeader)));
  }
  if (!before.empty() && !(v[0] > before.back().t)) {
    return fail(refuse(csv, number, "The times of the hand's path do not rise.")
                    .butFound(std::to_string(v[0]) + " s")
                    .wants("later than " + std::to_string(before.back().t) + " s"));
  }
  Row row;
  row.t = v[0];
  row.p = {metres(v[1]), metres(v[2]), metres(v[3])};
  row.q = Eigen::Quaterniond(v[4], v[5], v[6], v[7]);
  if (std::abs(row.q.norm() - 1.0) > kUnitTolerance) {
    return fail(refuse(csv, number, "A row of the hand's path has no orientation.")
                    .butFound("a quaternion of length " + std::to_string(row.q.norm()))
                    .wants("length 1 (qw,qx,qy,qz)"));
  }
  row.q.normalize();
  if (v[8] < 0.0 || v[8] > 255.0 || v[8] != std::floor(v[8])) {
    return fail(refuse(csv, number, "A row of the hand's path has impossible buttons.")
                    .butFound(std::to_string(v[8]))
                    .wants("a whole number from 0 to 255"));
  }
  row.buttons = static_cast<std::uint32_t>(v[8]);
  return row;
}

}  // namespace

Result<std::unique_ptr<Hand>> readScriptedHand(const std::filesystem::path& csv) {
  std::ifstream in(csv);
  if (!in || std::filesystem::is_directory(csv)) {
    return fail(inputRefused("The hand's path cannot be opened.")
                    .inFile(csv.string())
                    .advise("Check that the file exists and may be read."));
  }
  std::string line;
  std::size_t number = 1;
  std::getline(in, line);
  if (trimmed(line) != kHeader) {
    return fail(refuse(csv, number, "The file is not a hand's path: its first line is another.")
                    .butFound(quoted(std::string_view(line).substr(0, 80)))
                    .wants(std::string(kHeader)));
  }
  std::vector<Row> rows;
  while (std::getline(in, line)) {
    ++number;
    if (trimmed(line).empty()) continue;
    auto row = parseRow(csv, number, trimmed(line), rows);
    if (!row) return fail(row.error());
    rows.push_back(*row);
  }
  if (rows.empty()) {
    return fail(refuse(csv, number, "The hand's path has no rows.")
                    .wants("at least one row after the header"));
  }
  return std::make_unique<ScriptedHand>(std::move(rows));
}

}  // namespace palpate
