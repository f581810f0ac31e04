#pragma once
/// What drives a simulated device: the hand's intended stylus pose, and whether it grips.
///
/// A hand is asked once a servo tick on the servo thread (real-time safe). It knows only what a
/// hand knows: the time, where the stylus is, and what it feels.
///
/// Where the hand is at home: the origin of D lies on the anatomy's surface, -y of D points into
/// the anatomy, +z towards the user (whoever computes X_WD sees to it). The stylus' own +z, its
/// shaft towards the hand, lies along +y of D tilted 30° towards +z of D: stylusAtRest().

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

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
static_assert(std::is_trivially_copyable_v<HandTarget>);

class Hand {
 public:
  virtual ~Hand() = default;
  [[nodiscard]] virtual HandTarget target(double t, const DeviceSample& stylus_D,
                                          const Wrench& felt_D) noexcept = 0;
};

/// The stylus above the anatomy, `height` metres along +y of D, hanging as described above.
[[nodiscard]] PlainPose stylusAtRest(double height) noexcept;

/// A file of `t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,buttons` (interface.md): linear and spherical
/// interpolation, the first row before its time, the last row held. Refused by file and line: a
/// missing or other header, a row that is not nine finite numbers, times that do not rise, a
/// quaternion whose length is not 1 within 0.01, buttons that are not a whole number from 0 to 255.
[[nodiscard]] Result<std::unique_ptr<Hand>> readScriptedHand(const std::filesystem::path& csv);

/// What a stylus did, for a hand or a device to do it again.
struct RecordedPose {
  double t = 0.0;    ///< s, rising
  PlainPose pose_D;  ///< device frame
  std::uint32_t buttons = 0;
};

/// Wants the stylus where it was recorded: linear and spherical between the records, the first
/// before its time, after the last its pose with the button let go. Refused: no record, a pose that
/// is not rigid, times that do not rise.
[[nodiscard]] Result<std::unique_ptr<Hand>> makeRecordedHand(std::vector<RecordedPose> records);

/// The built-in hand finds the anatomy by feel alone: it starts 40 mm above (+y of D), goes down at
/// 50 mm/s until it feels more than 0.3 N, presses to about 1 N, slides 15 mm across (x, z of D)
/// and back holding that force, lifts off, and does it again elsewhere within 10 mm, place and
/// direction by the seed. Finding nothing 40 mm below, it gives up that place. Moves like a person:
/// its intent passes a 5 Hz filter. It holds the button all the while.
[[nodiscard]] std::unique_ptr<Hand> makeSearchingHand(std::uint64_t seed);

/// Follows the newest target of another thread (the window's mouse), low-passed at 8 Hz (above it a
/// hand follows nothing, haptics_facts.md §5; and a mouse moves in steps).
class FollowingHand : public Hand {
 public:
  explicit FollowingHand(const HandTarget& start) noexcept;
  /// One thread (the ui's).
  void follow(const HandTarget& target) noexcept { newest_.publish(target); }
  [[nodiscard]] HandTarget target(double t, const DeviceSample& stylus_D,
                                  const Wrench& felt_D) noexcept override;

 private:
  LatestValue<HandTarget> newest_;
  HandTarget wanted_, current_;
  double last_ = 0.0;
  bool started_ = false;
};

}  // namespace palpate
