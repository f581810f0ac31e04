#pragma once
/// Every error code of HDAPI: its name, what it does to the driver, and a sentence for a person.

#include <cstdint>
#include <span>

namespace palpate::hd {

/// What the driver is; ordered by how bad, so that the worse of two wins. Only Ready lets force
/// out.
enum class DriverState : std::uint8_t {
  Ready,
  Calibrating,  ///< The pose is not to be trusted yet; guidance() says what the person does.
  Refused,      ///< The vendor's own safety dropped a force. Comes back by itself after 0.1 s.
  Warm,         ///< The motors are too warm. Comes back after 2 s without the complaint.
  Fault,        ///< The vendor's library or the device reports a fault.
  Lost,         ///< The device does not answer.
  Closed,
};
[[nodiscard]] const char* name(DriverState state) noexcept;

struct ErrorMeaning {
  std::uint32_t code = 0;
  const char* name = "";  ///< The vendor's name of it, without HD_.
  DriverState state = DriverState::Fault;
  /// Comes back by itself after so many ticks without an error and with good poses; 0: only by
  /// closing and opening (or reconnecting) the device.
  std::uint32_t healTicks = 0;
  const char* sentence = "";  ///< What happened and what to do.
};

/// The meaning of a code; codes that HDAPI does not define give a Fault that says so. Real-time
/// safe.
[[nodiscard]] const ErrorMeaning& meaningOf(std::uint32_t code) noexcept;

/// All of them, kSuccess first.
[[nodiscard]] std::span<const ErrorMeaning> allErrors() noexcept;

}  // namespace palpate::hd
