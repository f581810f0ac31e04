#pragma once
/// Numbers as text of constant width, with their unit, for places where nothing may move.

#include <cstdint>
#include <string>

namespace palpate::ui {

/// `digits` places before the point (spaces in front, as wide as a digit), `decimals` after, then a
/// thin gap and the unit. Numbers too large show as the largest that fits with a '>' in front;
/// what is not finite shows as dashes.
[[nodiscard]] std::string fixed(double value, int digits, int decimals, const std::string& unit);

/// The same for whole numbers.
[[nodiscard]] std::string fixedCount(std::uint64_t value, int digits, const std::string& unit);

/// 1234567 as "1 234 567" (narrow gaps).
[[nodiscard]] std::string grouped(std::uint64_t value);

/// "0.96 × 0.96 × 1.50 mm".
[[nodiscard]] std::string spacingText(double x_mm, double y_mm, double z_mm);

/// Seconds as m:ss.t
[[nodiscard]] std::string clockText(double seconds);

}  // namespace palpate::ui
