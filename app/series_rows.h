#pragma once
/// What `palpate series --json` says, as the rows of the window's list.

#include <string>
#include <vector>

#include "ui/model.h"

namespace palpate {

/// Empty where the text is not such an object. With --names and --thumbnails, those too.
[[nodiscard]] std::vector<ui::SeriesRow> seriesRows(const std::string& json);

/// A sentence without its last clause where that names a command or an option: the window has a
/// button for it.
[[nodiscard]] std::string withoutCommandLine(const std::string& sentence);

}  // namespace palpate
