#pragma once
/// What a prepared scene models, what it leaves out, and what it costs (simulate --explain).

#include <cstdint>
#include <vector>

#include "core/simulation/prepared_scene.h"

namespace palpate {

[[nodiscard]] std::vector<PlanRow> planOf(const PreparedScene& prepared,
                                          const std::vector<std::uint8_t>& feltValues,
                                          double shellSpacing, bool approachIsClear);

/// What the governor may step down to.
[[nodiscard]] PlanRow governorRow(const PreparedScene& prepared);
inline constexpr const char* kGovernorRow = "governor";
inline constexpr const char* kRegionRow = "outside the region";
inline constexpr const char* kCavitiesRow = "sealed cavities";
inline constexpr const char* kWorkspaceRow = "beyond the device's workspace";

}  // namespace palpate
