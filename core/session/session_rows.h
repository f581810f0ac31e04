#pragma once
/// The rows of a session as bytes: samples, steps, commands, the report. Format 1.

#include <optional>
#include <span>

#include "core/haptics/virtual_coupling.h"
#include "core/session/pack.h"
#include "core/simulation/runner.h"

namespace palpate {

void pack(Packer& to, const ServoSample& sample);
void pack(Packer& to, const StepRecord& step);
void pack(Packer& to, const RunReport& report);
void pack(Packer& to, const CouplingGains& gains);

/// Nothing where the bytes are not exactly such a row.
[[nodiscard]] std::optional<ServoSample> unpackSample(std::span<const std::uint8_t> bytes);
[[nodiscard]] std::optional<StepRecord> unpackStep(std::span<const std::uint8_t> bytes);
[[nodiscard]] std::optional<RunReport> unpackReport(std::span<const std::uint8_t> bytes);
[[nodiscard]] std::optional<CouplingGains> unpackGains(std::span<const std::uint8_t> bytes);

}  // namespace palpate
