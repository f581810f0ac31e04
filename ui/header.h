#pragma once
/// The header row: product, task tabs, the case, the device chip.

#include "ui/model.h"
#include "ui/widgets.h"

namespace palpate::ui {

void drawHeader(const Painter& paint, const Rect& area, const Model& model);
/// What the chip says: which degrees of freedom are felt.
[[nodiscard]] std::string feltSentence(const DeviceInfo& info);
[[nodiscard]] const char* taskName(Task task);

}  // namespace palpate::ui
