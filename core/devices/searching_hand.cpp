#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/devices/hand.h"
#include "core/devices/random.h"

namespace palpate {
namespace {

// All in D: metres, seconds, newtons.
constexpr double kStartHeight = 0.040;
constexpr double kLowest = -0.040;        // of the intent: nothing here
constexpr double kDeepestIntent = 0.035;  // below where it first felt something
constexpr double kDownSpeed = 0.050;
constexpr double kPressSpeed = 0.020;
constexpr double kUpSpeed = 0.060;
constexpr double kAcrossSpeed = 0.015;
constexpr double kAcross = 0.015;
constexpr double kElsewhere = 0.010;  // radius of the places
constexpr double kTouch = 0.3;
constexpr double kPress = 1.0;
constexpr double kLost = 0.1;
constexpr double kForceGain = 0.020;   // m/s of intent per N lacking: slow against the arm
constexpr double kPressLongest = 2.0;  // a device that saturates below 1 N never gets there
constexpr double kWait = 0.3;
constexpr double kIntentHz = 5.0;  // a hand's bandwidth (haptics_facts.md §5)
constexpr double kSway = 0.10;     // rad: the stylus leans to and fro while sliding

class SearchingHand final : public Hand {
 public:
  explicit SearchingHand(std::uint64_t seed) noexcept : random_(seed) { aim(true); }

  HandTarget target(double t, const DeviceSample&, const Wrench& felt_D) noexcept override {
    const double dt = started_ ? std::clamp(t - last_, 0.0, 0.1) : 0.0;
    last_ = t;
    const Eigen::Vector3d f(felt_D.force[0], felt_D.force[1], felt_D.force[2]);
    act(dt, std::isfinite(f.norm()) ? f.norm() : 0.0);
    follow(dt);
    started_ = true;

    HandTarget out;
    const Eigen::Quaterniond lean = expMap(Eigen::Vector3d(0.0, 0.0, lean_));
    out.pose_D = plain(smooth_, (lean * orientation(stylusAtRest(0.0))).normalized());
    return out;
  }

 private:
  enum class Deed : std::uint8_t { Wait, Descend, Press, Slide, Lift };

  void begin(Deed deed) noexcept {
    deed_ = deed;
    since_ = 0.0;
  }

  /// A new place and direction.
  void aim(bool first) noexcept {
    const double radius = first ? 0.0 : kElsewhere * std::sqrt(random_.uniform(0.0, 1.0));
    const double place = random_.uniform(0.0, 2.0 * std::numbers::pi);
    place_ = {radius * std::cos(place), 0.0, radius * std::sin(place)};
    const double way = random_.uniform(0.0, 2.0 * std::numbers::pi);
    way_ = {std::cos(way), 0.0, std::sin(way)};
    place_.y() = kStartHeight;
    if (first) smooth_ = smooth1_ = intent_ = place_;
  }

  void act(double dt, double felt) noexcept {
    since_ += dt;
    switch (deed_) {
      case Deed::Wait:
        if (goTo(place_, kUpSpeed * dt) && since_ >= kWait) begin(Deed::Descend);
        break;
      case Deed::Descend:
        intent_.y() -= kDownSpeed * dt;
        if (felt > kTouch) {
          touched_ = intent_.y();
          begin(Deed::Press);
        } else if (intent_.y() < kLowest) {
          begin(Deed::Lift);
        }
        break;
      case Deed::Press:
        lower(kPressSpeed * dt);
        if (felt >= kPress || since_ > kPressLongest) {
          from_ = intent_;
          begin(Deed::Slide);
        } else if (felt < kLost && since_ > 0.5) {
          begin(Deed::Descend);  // it slipped off: look for it again
        }
        break;
      case Deed::Slide:
        slide(dt, felt);
        break;
      case Deed::Lift:
        intent_.y() += kUpSpeed * dt;
        lean_ *= std::exp(-5.0 * dt);
        if (intent_.y() >= kStartHeight) {
          aim(false);
          begin(Deed::Wait);
        }
        break;
    }
  }

  void slide(double dt, double felt) noexcept {
    const double out = kAcross / kAcrossSpeed;  // seconds one way
    const double way =
        since_ < out ? since_ * kAcrossSpeed : kAcross - (since_ - out) * kAcrossSpeed;
    intent_.x() = from_.x() + way * way_.x();
    intent_.z() = from_.z() + way * way_.z();
    lean_ = kSway * std::sin(std::numbers::pi * since_ / out);
    const double speed = std::clamp(kForceGain * (kPress - felt), -kPressSpeed, kPressSpeed);
    lower(speed * dt);
    if (since_ >= 2.0 * out) begin(Deed::Lift);
  }

  /// Towards a place by at most `most` metres. True: it is there.
  bool goTo(const Eigen::Vector3d& place, double most) noexcept {
    const Eigen::Vector3d way = place - intent_;
    const double left = way.norm();
    if (left <= most) {
      intent_ = place;
      return true;
    }
    intent_ += way * (most / left);
    return false;
  }

  void lower(double by) noexcept {
    intent_.y() = std::max(intent_.y() - by, touched_ - kDeepestIntent);
  }

  /// Two equal first-order stages.
  void follow(double dt) noexcept {
    const double a = 1.0 - std::exp(-2.0 * std::numbers::pi * kIntentHz * dt);
    smooth1_ += a * (intent_ - smooth1_);
    smooth_ += a * (smooth1_ - smooth_);
  }

  Random random_;
  Deed deed_ = Deed::Wait;
  double since_ = 0.0, last_ = 0.0, touched_ = 0.0, lean_ = 0.0;
  bool started_ = false;
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero(), way_ = Eigen::Vector3d::UnitX();
  Eigen::Vector3d from_ = Eigen::Vector3d::Zero(), intent_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d smooth1_ = Eigen::Vector3d::Zero(), smooth_ = Eigen::Vector3d::Zero();
};

}  // namespace

std::unique_ptr<Hand> makeSearchingHand(std::uint64_t seed) {
  return std::make_unique<SearchingHand>(seed);
}

}  // namespace palpate
