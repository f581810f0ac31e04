#pragma once
/// What the render thread sees of the simulation: plain data through a triple buffer.

#include <array>
#include <cstdint>
#include <type_traits>

#include "core/collision/contact.h"
#include "core/geometry/pose.h"
#include "core/haptics/messages.h"
#include "core/haptics/safety.h"
#include "core/haptics/virtual_coupling.h"

namespace palpate {

/// Times in µs over the last second.
struct Timing {
  double p50 = 0, p99 = 0, p999 = 0, max = 0;
};

struct Snapshot {
  static constexpr std::size_t kContactsDrawn = 4096;
  static constexpr std::size_t kBodiesDrawn = 64;

  std::uint64_t step = 0;
  std::uint64_t tick = 0;
  double t = 0.0;                    ///< Simulated seconds.
  PlainPose tool;                    ///< X_WT
  PlainPose device;                  ///< The stylus in W: where the hand wants the tool.
  Wrench felt;                       ///< What left the program, W.
  Wrench contact;                    ///< Full wrench of the contacts on the tool, W.
  std::uint32_t contacts = 0;        ///< All of them.
  std::uint32_t contactsDrawn = 0;   ///< Of these, the deepest kContactsDrawn or fewer.
  double depth = 0.0;                ///< Deepest, m.
  CouplingGains coupling;            ///< In force: lower than the device's where steps are long.
  double stepPeriod = 1e-3;          ///< s, of the last step
  std::uint32_t bodies = 0;          ///< Loose bodies of the scene, the first kBodiesDrawn of them.
  std::uint32_t levels = 0;          ///< Of the scene; 0: no governor.
  std::uint32_t level = 0;           ///< In force; 0 the finest.
  std::uint64_t levelChanges = 0;    ///< So far.
  double levelSince = 0.0;           ///< Simulated seconds: when the level was taken.
  std::array<char, 32> levelName{};  ///< Ends with 0; cut where it is longer.
  SafetyState safety = SafetyState::Disarmed;
  SafetyFault fault = SafetyFault::None;
  Timing stepTime, tickTime;
  std::uint64_t ticksLate = 0, ticksMissed = 0;
  std::array<PlainPose, kBodiesDrawn> body{};       ///< X_WB; at rest B is W.
  std::array<Contact, kContactsDrawn> contact_W{};  ///< p and n in W.
};
static_assert(std::is_trivially_copyable_v<Snapshot>);

}  // namespace palpate
