#pragma once
/// Hands that do one thing.

#include <algorithm>
#include <memory>

#include "core/devices/hand.h"

namespace palpate::stability {

/// Goes down at 50 mm/s to a depth of intent and holds still.
class PressingHand final : public Hand {
 public:
  PressingHand(double from, double to) : from_(from), to_(to) {}
  HandTarget target(double t, const DeviceSample&, const Wrench&) noexcept override {
    return {stylusAtRest(std::max(to_, from_ - 0.05 * std::max(0.0, t - 0.4))), 1, true};
  }

 private:
  double from_, to_;
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
