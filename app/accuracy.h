#pragma once
/// Named settings for `replay --accuracy`.

#include <memory>
#include <string>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/simulation/prepared_scene.h"

namespace palpate {

inline constexpr const char* kRecordedAccuracy = "recorded";

/// "recorded, fine, reference".
[[nodiscard]] std::string accuracyNames();
/// fine: distance leaves, full descent, no contact budget, at least 1000 solver iterations; the
/// shell stays, so that contacts compare. reference: fine, by brute force. Unknown: Usage error.
[[nodiscard]] Result<SimulationSetting> settingOfAccuracy(const std::string& name,
                                                          SimulationSetting recorded);
/// The same anatomy and instrument, prepared with another setting.
[[nodiscard]] Result<std::shared_ptr<const PreparedScene>> withSetting(
    const PreparedScene& prepared, const SimulationSetting& setting, const Progress& progress);

}  // namespace palpate
