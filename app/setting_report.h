#pragma once
/// Settings, timings and sizes as the commands print them; a change of a word here is a change of
/// the interface.

#include <nlohmann/json.hpp>
#include <string>

#include "core/scene/scene.h"
#include "core/simulation/snapshot.h"

namespace palpate {

/// {topology, payload, total}
[[nodiscard]] nlohmann::ordered_json bytesJson(const TreeStats& stats);
/// {p50, p99, p999, max}
[[nodiscard]] nlohmann::ordered_json timingJson(const Timing& timing);
/// Every field of a SimulationSetting, lengths in mm, times in ms.
[[nodiscard]] nlohmann::ordered_json settingJson(const SimulationSetting& setting);
/// 16 hex digits.
[[nodiscard]] std::string hashText(std::uint64_t hash);

[[nodiscard]] const char* leafName(LeafModel leaf) noexcept;
[[nodiscard]] const char* methodName(QueryMethod method) noexcept;

}  // namespace palpate
