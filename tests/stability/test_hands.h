#pragma once
/// Hands that do one thing.

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "core/devices/hand.h"

namespace palpate::stability {

/// The stylus straight up, its tip `height` metres along +y of D.
inline PlainPose upright(double height) {
  const double half = -0.25 * std::numbers::pi;  // half of a quarter turn about x: +z to +y
  return plain(Eigen::Vector3d(0.0, height, 0.0),
               Eigen::Quaterniond(std::cos(half), std::sin(half), 0.0, 0.0));
}

/// Goes down at 50 mm/s to a depth of intent and holds still.
class PressingHand final : public Hand {
 public:
  PressingHand(double from, double to, bool straight = false)
      : from_(from), to_(to), straight_(straight) {}
  HandTarget target(double t, const DeviceSample&, const Wrench&) noexcept override {
    const double height = std::max(to_, from_ - 0.05 * std::max(0.0, t - 0.4));
    return {straight_ ? upright(height) : stylusAtRest(height), 1, true};
  }

 private:
  double from_, to_;
  bool straight_;
};

/// Another hand, that lets go for good at a time; the button stays down.
class LettingGo final : public Hand {
 public:
  LettingGo(std::shared_ptr<Hand> hand, double when) : hand_(std::move(hand)), when_(when) {}
  HandTarget target(double t, const DeviceSample& s, const Wrench& felt) noexcept override {
    HandTarget out = hand_->target(t, s, felt);
    out.present = t < when_;
    return out;
  }

 private:
  std::shared_ptr<Hand> hand_;
  double when_;
};

}  // namespace palpate::stability
