#pragma once
/// What devices there are, what was tried to find them, and why something is not there: for
/// `palpate devices`.

#include <string>
#include <vector>

#include "core/devices/hdapi.h"
#include "core/devices/phantom.h"
#include "core/haptics/device.h"

namespace palpate {

struct ListedDevice {
  /// What one asks for it by: a simulated model ("touch-x"), "3d-mouse", or "phantom", or
  /// "phantom:NAME" with its name in the vendor's set-up.
  std::string name;
  DeviceInfo info;
  bool there = false;
  std::string note;    ///< A sentence: what to know of it, or why it is not there.
  std::string advice;  ///< A sentence: what to do where it is not there; may be empty.

  // Of a Phantom that is there. The serial number is left out on purpose.
  std::string firmware, driverVersion, vendor;
  std::string calibration;               ///< "done", or how it is done: "inkwell".
  std::vector<double> motorTemperature;  ///< 0 cold to 1 too hot
};

struct DeviceList {
  std::vector<ListedDevice> devices;
  std::vector<hd::LibraryAttempt> libraries;  ///< Each name of the vendor's library tried.
  std::string library;                        ///< Path of the one that was found; else empty.
  std::string mouseLibrary;                   ///< libspnav, where it was found.
};

/// The name that a 3D mouse is asked for by: it moves a simulated Touch X.
inline constexpr const char* kSpaceMouse = "3d-mouse";

/// Takes and gives back each Phantom of `names` for a moment, without force; so not while one is in
/// use in this program. Not for the loops.
[[nodiscard]] DeviceList listDevices(const PhantomOptions& options = {});

/// "phantom" or "phantom:NAME". Usage: any other name.
[[nodiscard]] Result<PhantomOptions> phantomOptions(const std::string& deviceName);

/// What a person reads of the library: found where, or what was tried and what to do.
[[nodiscard]] std::string librarySentence(const DeviceList& list);

}  // namespace palpate
