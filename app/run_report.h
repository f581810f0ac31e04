#pragma once
/// What a run measured, as the JSON of `simulate --json` and of the window's soak.

#include <nlohmann/json.hpp>

#include "core/simulation/runner.h"

namespace palpate {

[[nodiscard]] nlohmann::ordered_json runReportJson(const RunReport& report,
                                                   const PreparedScene& scene);

}  // namespace palpate
