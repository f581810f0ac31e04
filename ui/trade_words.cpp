#include "ui/trade_words.h"

#include <cstdio>
#include <sstream>

namespace palpate::ui {

namespace {

std::string changeWords(const std::string& name) {
  const std::size_t equals = name.find('=');
  const std::string option = name.substr(0, equals);
  const std::string value = equals == std::string::npos ? std::string{} : name.substr(equals + 1);
  // "1.00mm", "500Hz": a space before the unit.
  const std::size_t digits = value.find_first_not_of("0123456789.");
  const std::string amount = digits == std::string::npos || digits == 0
                                 ? value
                                 : value.substr(0, digits) + " " + value.substr(digits);
  if (name == "default") return "as the scene says";
  if (option == "shell") return "a point every " + amount;
  if (option == "iterations") return amount + " impulses a step";
  if (option == "leaf") return value + " leaves";
  if (option == "perceptual") return "details below " + amount + " left out";
  if (option == "rate") return amount;
  return name;
}

}  // namespace

std::string settingWords(const std::string& name) {
  std::istringstream changes(name);
  std::string change, all;
  while (changes >> change) all.append(all.empty() ? "" : ", ").append(changeWords(change));
  return all;
}

std::string numbersText(const TradeRowModel& row) {
  char text[96];
  std::snprintf(text, sizeof text, "%.2f mm, %.2f N, %.0f \xc2\xb5s", row.depth_mm, row.force_N,
                row.p999_us);
  return text;
}

std::string errorText(const TradeModel& trade) {
  if (trade.chosen >= trade.rows.size()) return "error not measured";
  const TradeRowModel& row = trade.rows[trade.chosen];
  char text[96];
  std::snprintf(text, sizeof text, "\xc2\xb1%.2f mm  \xc2\xb1%.2f N", row.depth_mm, row.force_N);
  return text;
}

}  // namespace palpate::ui
