#include "core/devices/phantom_calibration.h"

#include "core/devices/hdapi.h"

namespace palpate {

std::uint32_t chooseCalibrationStyle(std::uint32_t styles) noexcept {
  for (const std::uint32_t style : {hd::kStyleAuto, hd::kStyleInkwell, hd::kStyleEncoderReset})
    if ((styles & style) != 0) return style;
  return 0;
}

const char* calibrationStyleName(std::uint32_t style) noexcept {
  switch (style) {
    case hd::kStyleAuto:
      return "automatic";
    case hd::kStyleInkwell:
      return "inkwell";
    case hd::kStyleEncoderReset:
      return "encoder reset";
    default:
      return "none";
  }
}

const char* calibrationGuidance(std::uint32_t style) noexcept {
  switch (style) {
    case hd::kStyleAuto:
      return "Move the stylus slowly through the whole of its range: the arm calibrates itself.";
    case hd::kStyleInkwell:
      return "Put the stylus into the inkwell and leave it there for a second.";
    case hd::kStyleEncoderReset:
      return "Bring the arm into its reset position, all links at right angles and the stylus "
             "level, hold it still and confirm.";
    default:
      return "Calibrate the device with the vendor's tool: it names no way that Palpate knows.";
  }
}

Calibration::Action Calibration::decide(const Poll& poll) const noexcept {
  if (poll.status == hd::kCalibrationOk) return Action::None;
  // A reset of the encoders anywhere but in the reset position would give wrong poses for good, so
  // nobody but the person starts it.
  if (style_ == hd::kStyleEncoderReset) return poll.confirmed ? Action::Update : Action::Wait;
  if (poll.status == hd::kCalibrationNeedsUpdate && style_ != 0) return Action::Update;
  if (style_ == hd::kStyleInkwell && poll.docked) return Action::Update;
  return Action::Wait;
}

}  // namespace palpate
