#include "app/series_rows.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/base/counted.h"
#include "ui/format.h"

namespace palpate {
namespace {

using nlohmann::json;

constexpr const char* kDot = " \xc2\xb7 ";
constexpr const char* kTimes = " \xc3\x97 ";

/// Empty where a text is missing or not a text.
std::string textOf(const json& object, const char* key) {
  return object.contains(key) && object[key].is_string() ? object[key].get<std::string>() : "";
}

bool isTriple(const json& object, const char* key) {
  return object.contains(key) && object[key].is_array() && object[key].size() == 3;
}

/// "Doe^Peter" is family and given name; other scripts follow behind a '='. Parts may be empty.
std::string readableName(const std::string& name) {
  std::string text;
  const char* between = "";
  for (const char c : name) {
    if (c == '=') {
      between = text.empty() ? "" : kDot;
    } else if (c == '^' || c == ' ') {
      if (*between == 0 && !text.empty()) between = " ";
    } else {
      text += between;
      text += c;
      between = "";
    }
  }
  return text;
}

std::string readableDate(const std::string& date) {
  if (date.size() != 8) return date;
  return date.substr(0, 4) + "-" + date.substr(4, 2) + "-" + date.substr(6, 2);
}

std::string studyOf(const json& series) {
  const std::string name = readableName(textOf(series, "patient_name"));
  const std::string date = readableDate(textOf(series, "study_date"));
  const std::string number = std::to_string(series.value("study", 1));
  std::string text = name.empty() ? "Study " + number : name;
  return date.empty() ? text : text + kDot + date;
}

/// "it states no spacing" follows a colon; in the list it stands alone.
std::string reasonOf(const json& series) {
  std::string reason = withoutCommandLine(textOf(series, "reason"));
  if (!reason.empty() && reason[0] >= 'a' && reason[0] <= 'z') {
    reason[0] = static_cast<char>(reason[0] - 'a' + 'A');
  }
  return reason;
}

std::string sizeOf(const json& series) {
  const auto files = series.value("files", std::size_t{0});
  const double bytes = std::max(1e3, series.value("bytes", 0.0));
  char text[64];
  std::snprintf(text, sizeof text, "%.*f %s", bytes >= 1e6 && bytes < 1e7 ? 1 : 0,
                bytes >= 1e6 ? bytes / 1e6 : bytes / 1e3, bytes >= 1e6 ? "MB" : "kB");
  return counted(files, "file", "files") + kDot + text;
}

std::string gridOf(const json& series) {
  if (!isTriple(series, "dims")) return {};
  const auto& d = series["dims"];
  return std::to_string(d[0].get<int>()) + kTimes + std::to_string(d[1].get<int>()) + kTimes +
         std::to_string(d[2].get<int>());
}

std::string spacingOf(const json& series) {
  if (!isTriple(series, "spacing_mm")) return {};
  const auto& s = series["spacing_mm"];
  return ui::spacingText(s[0].get<double>(), s[1].get<double>(), s[2].get<double>());
}

GreyPicture pictureOf(const json& series) {
  GreyPicture picture;
  if (!series.contains("thumbnail") || !series["thumbnail"].is_object()) return picture;
  const json& from = series["thumbnail"];
  const std::string digits = textOf(from, "grey");
  const int width = from.value("width", 0);
  const int height = from.value("height", 0);
  if (width <= 0 || height <= 0 || width > 256 || height > 256) return picture;
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (digits.size() != 2 * pixels) return picture;
  picture.width = width;
  picture.height = height;
  for (std::size_t i = 0; i < pixels; ++i) {
    picture.grey.push_back(
        static_cast<std::uint8_t>(std::strtol(digits.substr(2 * i, 2).c_str(), nullptr, 16)));
  }
  return picture;
}

}  // namespace

std::string withoutCommandLine(const std::string& sentence) {
  for (const char* clause : {"; imports with --repair", "; `palpate "}) {
    const std::size_t at = sentence.find(clause);
    if (at == std::string::npos) continue;
    return sentence.substr(0, at) + (sentence.back() == '.' ? "." : "");
  }
  return sentence;
}

std::vector<ui::SeriesRow> seriesRows(const std::string& output) {
  std::vector<ui::SeriesRow> rows;
  const json all = json::parse(output, nullptr, false);
  if (!all.is_object() || !all.contains("series")) return rows;
  for (const json& series : all["series"]) {
    ui::SeriesRow row;
    row.uid = textOf(series, "uid");
    row.importable = series.value("importable", false);
    row.repairable = !textOf(series, "repair").empty();
    row.reason = reasonOf(series);
    const std::string description = textOf(series, "description");
    const std::string modality = textOf(series, "modality");
    row.title = description.empty() ? (modality.empty() ? "Series" : modality + " series")
                                    : (modality.empty() ? "" : modality + kDot) + description;
    row.grid = gridOf(series);
    row.spacing = spacingOf(series);
    row.size = sizeOf(series);
    row.study = studyOf(series);
    row.studyNumber = series.value("study", std::size_t{1});
    row.picture = pictureOf(series);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace palpate
