#include "ui/format.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace palpate::ui {
namespace {

// U+2007, the figure space: as wide as a digit.
constexpr const char* kFigureSpace = "\xe2\x80\x87";
constexpr const char* kFigureDash = "\xe2\x80\x92";
constexpr const char* kMinus = "\xe2\x88\x92";
constexpr const char* kThinSpace = "\xe2\x80\x89";

std::string printed(const char* format, int decimals, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, decimals, value);
  return text;
}

/// To `width` characters; signs become ones that are as wide as a digit.
std::string padded(const std::string& number, std::size_t width) {
  std::string out;
  for (std::size_t i = number.size(); i < width; ++i) out += kFigureSpace;
  return !number.empty() && number[0] == '-' ? out + kMinus + number.substr(1) : out + number;
}

std::string withUnit(std::string number, const std::string& unit) {
  return unit.empty() ? number : number + " " + unit;
}

}  // namespace

std::string fixed(double value, int digits, int decimals, const std::string& unit) {
  const auto width = static_cast<std::size_t>(digits + (decimals > 0 ? decimals + 1 : 0));
  if (!std::isfinite(value)) {
    // The decimal point stays: it is narrower than a digit.
    std::string dashes = padded("", static_cast<std::size_t>(digits - 1)) + kFigureDash;
    if (decimals > 0) dashes += '.';
    for (int i = 0; i < decimals; ++i) dashes += kFigureDash;
    return withUnit(dashes, unit);
  }
  const double limit = std::pow(10.0, digits) - std::pow(10.0, -decimals);
  if (std::abs(value) > limit + 0.5 * std::pow(10.0, -decimals)) {
    const double most = std::pow(10.0, digits - 1) - std::pow(10.0, -decimals);
    std::string text(1, '>');
    text += printed("%.*f", decimals, std::max(0.0, most));
    return withUnit(padded(text, width), unit);
  }
  return withUnit(padded(printed("%.*f", decimals, value), width), unit);
}

std::string fixedCount(std::uint64_t value, int digits, const std::string& unit) {
  return fixed(static_cast<double>(value), digits, 0, unit);
}

std::string grouped(std::uint64_t value) {
  const std::string plain = std::to_string(value);
  std::string out;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    if (i > 0 && (plain.size() - i) % 3 == 0) out += kThinSpace;
    out += plain[i];
  }
  return out;
}

std::string spacingText(double x_mm, double y_mm, double z_mm) {
  char text[96];
  std::snprintf(text, sizeof text, "%.2f \xc3\x97 %.2f \xc3\x97 %.2f mm", x_mm, y_mm, z_mm);
  return text;
}

std::string clockText(double seconds) {
  if (!std::isfinite(seconds) || seconds < 0.0) return "-:--.-";
  const auto tenths = static_cast<long long>(std::floor(seconds * 10.0 + 1e-6));
  char text[48];
  std::snprintf(text, sizeof text, "%lld:%02lld.%lld", tenths / 600, (tenths / 10) % 60,
                tenths % 10);
  return text;
}

}  // namespace palpate::ui
