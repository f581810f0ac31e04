#pragma once
/// SI inside core; other units show in the name. The only place where the factors are written.

namespace palpate {

inline constexpr double kMetresPerMillimetre = 1e-3;
inline constexpr double kMillimetresPerMetre = 1e3;

[[nodiscard]] constexpr double metres(double mm) noexcept {
  return mm * kMetresPerMillimetre;
}
[[nodiscard]] constexpr double millimetres(double m) noexcept {
  return m * kMillimetresPerMetre;
}

}  // namespace palpate
