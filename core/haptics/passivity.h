#pragma once
/// Passivity observer and controller at the device's port (Hannaford and Ryu 2002; the exact form
/// for a held force, Stramigioli): E = -Σ F[k-1]·(x[k] - x[k-1]), torque likewise.

#include "core/haptics/messages.h"

namespace palpate {

/// Servo thread; real-time safe.
class PassivityObserver {
 public:
  /// Before the new wrench is computed: books what the last one did since the last sample.
  void observe(const DeviceSample& device) noexcept;
  /// Damps the wanted wrench if the balance is negative (the controller), no more than
  /// `maxDamping`.
  [[nodiscard]] Wrench dissipate(const Wrench& wanted, const DeviceSample& device, double period,
                                 double maxDamping) noexcept;
  /// What left the program this tick.
  void commit(const Wrench& sent) noexcept { sent_ = sent; }
  /// Energy taken from the hand since start, J. Must stay above -20 µJ less what was stored.
  [[nodiscard]] double energy() const noexcept { return energy_; }

 private:
  double energy_ = 0.0;
  Wrench sent_;
  PlainPose last_;
  bool started_ = false;
};

}  // namespace palpate
