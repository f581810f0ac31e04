#pragma once
/// Passivity observer and controller at the device's port (Hannaford and Ryu 2002; the exact form
/// for a held force, Stramigioli): E = -Σ F[k-1]·(x[k] - x[k-1]), torque likewise.

#include "core/haptics/messages.h"

namespace palpate {

/// Energy the port may be short of before the controller holds the force back, J. The promise is
/// -20 µJ; the rest is for what the prediction below misses.
inline constexpr double kPassivityReserve = 10e-6;
/// How far the device may at least move in a tick beyond what its filtered velocity says, m: two of
/// the coarsest encoder steps of a Phantom (55 µm). Twice as far as it did in the last second or
/// two, where that is more: an arm that vibrates is never where its velocity says.
inline constexpr double kUnforeseenMove = 1.2e-4;
/// Deficit at which the controller has evidently failed, J (haptics_facts.md §3: sustained
/// oscillation appeared only beyond 1 mJ).
inline constexpr double kEnergyFault = 5e-4;

/// Servo thread; real-time safe.
class PassivityObserver {
 public:
  /// Before the new wrench is computed: books what the last one did since the last sample.
  void observe(const DeviceSample& device) noexcept;
  /// Damps the wanted wrench if the balance is negative (the controller), no more than
  /// `maxDamping`.
  [[nodiscard]] Wrench dissipate(const Wrench& wanted, const DeviceSample& device, double period,
                                 double maxDamping) noexcept;
  /// The fraction (0..1) of `allowed` that may be sent so that the coming period, at the device's
  /// velocity and an unforeseen move along the force, gives the hand no more than the balance and
  /// the reserve hold. In ordinary touch 1: what pressing stored is far more. Never quite 0
  /// (0.2 µJ where the reserve ends, less and less towards -18 µJ; up to 0.2 µJ while the hand
  /// pushes against the force; else 0.1 nJ), or a spent balance could never be earned back.
  [[nodiscard]] double passiveFraction(const Wrench& allowed, const DeviceSample& device,
                                       double period) const noexcept;
  /// What left the program this tick.
  void commit(const Wrench& sent) noexcept { sent_ = sent; }
  /// Energy taken from the hand since start, J. Must stay above -20 µJ less what was stored.
  [[nodiscard]] double energy() const noexcept { return energy_; }
  /// The deficit is beyond the controller's reach.
  [[nodiscard]] bool failed() const noexcept { return energy_ - base_ < -kEnergyFault; }
  /// The balance starts anew from here (a fault was cleared); energy() goes on.
  void rebase() noexcept { base_ = energy_; }

 private:
  double energy_ = 0.0;
  double base_ = 0.0;
  double gained_ = 0.0;  ///< In the last tick.
  double unforeseen_ = kUnforeseenMove;
  Wrench sent_;
  DeviceSample last_;
  bool started_ = false;
};

}  // namespace palpate
