#pragma once
/// A 3Dconnexion mouse (through the spacenavd service) as the hand of a simulated device.
///
/// The mouse gives deflections, not positions, so it moves the stylus by rate: the farther the cap
/// is pushed, the faster the wish moves, up to 100 mm/s and 90 degrees a second, nothing within a
/// dead zone. Button 1 held is the stylus' button (force on). The mouse itself gives no force: what
/// would be felt is drawn. libspnav is found while the program runs; its events are read on a
/// thread of the hand's own, never the servo's. Where the service goes away the wish stays where it
/// is, the button counts as let go, and the hand looks for it again every second.

#include <memory>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/devices/hand.h"

namespace palpate {

struct SpaceMouseOptions {
  /// Tried in this order; PALPATE_SPNAV_LIBRARY, where set, before them.
  std::vector<std::string> libraries{"libspnav.so.0", "libspnav.so"};
  double fullDeflection = 350.0;  ///< Counts of the cap at its end.
  double deadZone = 0.06;         ///< Of the full deflection.
  double fastest = 0.1;           ///< m/s at full deflection
  double fastestTurn = 1.57;      ///< rad/s
  double reach = 0.08;            ///< m: how far from D's origin the wish may go, along each axis.
  double startHeight = 0.04;      ///< m, along +y of D
};

/// What was found, for `palpate devices`.
struct SpaceMouseSearch {
  bool there = false;
  std::string library;  ///< Where one was found.
  std::string note;     ///< A sentence: what is there, or why not.
  std::string advice;   ///< A sentence; empty where it is there.
};

/// Connects for a moment. Not for the loops.
[[nodiscard]] SpaceMouseSearch findSpaceMouse(const SpaceMouseOptions& options = {});

/// Refused (Machine) where there is no library or the service does not answer, with what to do.
[[nodiscard]] Result<std::shared_ptr<Hand>> makeSpaceMouseHand(
    const SpaceMouseOptions& options = {});

}  // namespace palpate
