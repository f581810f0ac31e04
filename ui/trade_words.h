#pragma once
/// A measured setting in words and numbers.

#include <string>

#include "ui/model.h"

namespace palpate::ui {

/// "shell=1.00mm" as "a point every 1.00 mm", several with a comma between them; what is not known
/// stays as it is.
[[nodiscard]] std::string settingWords(const std::string& name);
/// "0.12 mm, 0.05 N, 310 µs".
[[nodiscard]] std::string numbersText(const TradeRowModel& row);
/// For the strip: "±0.12 mm  ±0.05 N" of the chosen setting, or that it is not measured.
[[nodiscard]] std::string errorText(const TradeModel& trade);

}  // namespace palpate::ui
