#pragma once
/// What drives a simulated device: the hand's intended stylus pose, and whether it grips.
///
/// A hand is asked once a servo tick on the servo thread (real-time safe). It knows only what a
/// hand knows: the time, where the stylus is, and what it feels.

#include <filesystem>
#include <memory>

#include "core/base/error.h"
#include "core/base/latest_value.h"
#include "core/geometry/pose.h"
#include "core/haptics/messages.h"

namespace palpate {

struct HandTarget {
  PlainPose pose_D;           ///< Where the hand wants the stylus, device frame, metres.
  std::uint32_t buttons = 1;  ///< Bit 0 held: enabled.
  bool present = true;        ///< False: nobody holds the stylus.
};

class Hand {
 public:
  virtual ~Hand() = default;
  [[nodiscard]] virtual HandTarget target(double t, const DeviceSample& stylus_D,
                                          const Wrench& felt_D) noexcept = 0;
};

/// A file of `t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,buttons` (interface.md): linear and spherical
/// interpolation, the last row held. Refused by file and line.
[[nodiscard]] Result<std::unique_ptr<Hand>> readScriptedHand(const std::filesystem::path& csv);

/// The built-in hand: waits, moves along -z of D... until it feels the anatomy, presses to about
/// 1 N, slides across it and back, lets go and retreats; then again elsewhere, varied by the seed.
[[nodiscard]] std::unique_ptr<Hand> makeSearchingHand(std::uint64_t seed);

/// Follows the newest target of another thread (the window's mouse), low-passed at 8 Hz.
class FollowingHand : public Hand {
 public:
  explicit FollowingHand(const HandTarget& start) noexcept;
  /// One thread (the ui's).
  void follow(const HandTarget& target) noexcept { newest_.publish(target); }
  [[nodiscard]] HandTarget target(double t, const DeviceSample& stylus_D,
                                  const Wrench& felt_D) noexcept override;

 private:
  LatestValue<HandTarget> newest_;
  HandTarget current_;
};

}  // namespace palpate
