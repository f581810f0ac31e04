#pragma once
/// How a Phantom is calibrated, and what the person does for it.

#include <cstdint>
#include <string>

namespace palpate {

/// The style the driver uses: of those in `styles` (a bitmask of hd::kStyle...) the one that asks
/// least of the person: automatic, inkwell, encoder reset; 0 where the device names none it knows.
[[nodiscard]] std::uint32_t chooseCalibrationStyle(std::uint32_t styles) noexcept;

/// "automatic", "inkwell", "encoder reset", or "none".
[[nodiscard]] const char* calibrationStyleName(std::uint32_t style) noexcept;

/// The sentence that guides the person while the device is not calibrated.
[[nodiscard]] const char* calibrationGuidance(std::uint32_t style) noexcept;

/// Decides at each poll. Real-time safe.
class Calibration {
 public:
  explicit Calibration(std::uint32_t style = 0) noexcept : style_(style) {}

  struct Poll {
    std::uint32_t status = 0;  ///< What hdCheckCalibration said.
    bool docked = false;       ///< The stylus is in the inkwell.
    bool confirmed = false;    ///< The person said that the arm is in its reset position.
  };
  enum class Action : std::uint8_t {
    None,    ///< Calibrated.
    Wait,    ///< For the person, or for the device.
    Update,  ///< Call hdUpdateCalibration(style()), with the force off; then poll again.
  };
  [[nodiscard]] Action decide(const Poll& poll) const noexcept;
  [[nodiscard]] std::uint32_t style() const noexcept { return style_; }

 private:
  std::uint32_t style_;
};

}  // namespace palpate
