#include "core/devices/space_mouse.h"

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <spnav.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

#include "core/devices/simulated_phantom.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;

SpaceMouseOptions options() {
  SpaceMouseOptions o;
  o.libraries = {FAKE_SPNAV};
  return o;
}

/// The service's side of the stand-in.
struct Service {
  Service() : library(dlopen(FAKE_SPNAV, RTLD_NOW)) {
    send = reinterpret_cast<void (*)(const spnav_event*)>(dlsym(library, "fake_spnav_send"));
    run = reinterpret_cast<void (*)(int)>(dlsym(library, "fake_spnav_run"));
    run(1);
  }
  void push(int x, int y, int z, int rx = 0, int ry = 0, int rz = 0) const {
    spnav_event e{};
    e.motion.type = SPNAV_EVENT_MOTION;
    e.motion.x = x;
    e.motion.y = y;
    e.motion.z = z;
    e.motion.rx = rx;
    e.motion.ry = ry;
    e.motion.rz = rz;
    send(&e);
  }
  void press(int number, bool down) const {
    spnav_event e{};
    e.button.type = SPNAV_EVENT_BUTTON;
    e.button.press = down ? 1 : 0;
    e.button.bnum = number;
    send(&e);
  }
  void* library;
  void (*send)(const spnav_event*);
  void (*run)(int);
};

/// A hand on a clock of its own; moves on by a tick each time it is looked at.
struct Driven {
  explicit Driven(std::shared_ptr<Hand> h) : hand(std::move(h)) { (void)look(); }
  HandTarget look() {
    t += 1e-3;
    return last = hand->target(t, {}, {});
  }
  bool eventually(const std::function<bool(const HandTarget&)>& so) {
    for (int i = 0; i < 3000; ++i) {
      if (so(look())) return true;
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }
  Eigen::Vector3d velocity() {
    const Eigen::Vector3d before = position(last.pose_D);
    return (position(look().pose_D) - before) / 1e-3;
  }
  std::shared_ptr<Hand> hand;
  HandTarget last;
  double t = 0.0;
};

TEST(SpaceMouse, MovesTheWishByRateAndNotInTheDeadZone) {
  const Service service;
  auto hand = makeSpaceMouseHand(options());
  ASSERT_TRUE(hand) << sentence(hand.error());
  Driven driven(*hand);
  EXPECT_EQ(position(driven.last.pose_D), position(stylusAtRest(0.04)));
  std::this_thread::sleep_for(50ms);
  service.push(350, 0, 0);  // to the end
  ASSERT_TRUE(driven.eventually([&](const HandTarget&) { return driven.velocity().x() > 0.01; }));
  EXPECT_NEAR(driven.velocity().x(), 0.1, 1e-9);
  EXPECT_NEAR(driven.velocity().y(), 0.0, 1e-9);
  service.push(0, 0, 175);  // half-way, away from the user: the square of what is beyond the zone
  ASSERT_TRUE(driven.eventually([&](const HandTarget&) { return driven.velocity().x() < 0.01; }));
  const double beyond = (0.5 - 0.06) / 0.94;
  EXPECT_NEAR(driven.velocity().z(), -0.1 * beyond * beyond, 1e-9);
  service.push(10, -10, 10);
  ASSERT_TRUE(
      driven.eventually([&](const HandTarget&) { return driven.velocity().norm() == 0.0; }));
}

TEST(SpaceMouse, TurnsAndStaysWithinReach) {
  const Service service;
  auto hand = makeSpaceMouseHand(options());
  ASSERT_TRUE(hand);
  Driven driven(*hand);
  std::this_thread::sleep_for(50ms);
  const Eigen::Quaterniond before = orientation(driven.last.pose_D);
  service.push(5000, 0, 0, 0, 0, 350);  // more than there is counts as the end
  ASSERT_TRUE(driven.eventually([&](const HandTarget&) { return driven.velocity().x() > 0.01; }));
  for (int i = 0; i < 2000; ++i) (void)driven.look();
  EXPECT_DOUBLE_EQ(position(driven.last.pose_D).x(), 0.08);
  const Eigen::Vector3d turn = logMap(orientation(driven.last.pose_D) * before.conjugate());
  EXPECT_GT(turn.norm(), 0.5);
  EXPECT_NEAR(turn.normalized().z(), turn.z() > 0 ? 1.0 : -1.0, 1e-6);
  EXPECT_TRUE(isRigid(driven.last.pose_D));
}

TEST(SpaceMouse, ButtonOneIsTheStylusButtonAndIsLetGoWhenTheServiceGoes) {
  const Service service;
  auto hand = makeSpaceMouseHand(options());
  ASSERT_TRUE(hand);
  Driven driven(*hand);
  std::this_thread::sleep_for(50ms);
  service.press(1, true);
  service.push(350, 0, 0);
  ASSERT_TRUE(driven.eventually([&](const HandTarget&) { return driven.velocity().x() > 0.01; }));
  EXPECT_EQ(driven.last.buttons, 0u);
  service.press(0, true);
  ASSERT_TRUE(driven.eventually([](const HandTarget& h) { return h.buttons == 1; }));
  std::this_thread::sleep_for(300ms);  // held still: nothing is sent, and nothing changes
  EXPECT_EQ(driven.look().buttons, 1u);
  service.run(0);  // the service is gone
  ASSERT_TRUE(driven.eventually([](const HandTarget& h) { return h.buttons == 0; }));
  EXPECT_EQ(driven.velocity().norm(), 0.0);
  const Eigen::Vector3d held = position(driven.last.pose_D);
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(position(driven.look().pose_D), held);
  service.run(1);  // and comes back
  std::this_thread::sleep_for(1300ms);
  service.press(0, true);
  EXPECT_TRUE(driven.eventually([](const HandTarget& h) { return h.buttons == 1; }));
}

TEST(SpaceMouse, WhatIsMissingIsSaidWithWhatToDo) {
  const Service service;
  SpaceMouseOptions none = options();
  none.libraries = {"libspnav-is-not-here.so"};
  auto hand = makeSpaceMouseHand(none);
  ASSERT_FALSE(hand);
  EXPECT_EQ(sentence(hand.error()),
            "The library of 3D mice (libspnav) could not be loaded. Field: device. Found: "
            "libspnav-is-not-here.so: not there. Install it: apt install libspnav0 spacenavd.");
  service.run(0);
  hand = makeSpaceMouseHand(options());
  ASSERT_FALSE(hand);
  EXPECT_EQ(hand.error().message, "The service of 3D mice (spacenavd) does not answer.");
  SpaceMouseSearch search = findSpaceMouse(options());
  EXPECT_FALSE(search.there);
  EXPECT_EQ(search.library, FAKE_SPNAV);
  EXPECT_FALSE(search.advice.empty());
  service.run(1);
  search = findSpaceMouse(options());
  EXPECT_TRUE(search.there);
  EXPECT_TRUE(search.advice.empty());
}

TEST(SpaceMouse, DrivesASimulatedArm) {
  const Service service;
  auto hand = makeSpaceMouseHand(options());
  ASSERT_TRUE(hand);
  auto device = makeSimulatedPhantom("touch-x", *hand, 1);
  ASSERT_TRUE(device);
  ASSERT_TRUE((*device)->open());
  std::this_thread::sleep_for(50ms);
  service.push(0, -350, 0);
  double y = 1.0;
  for (std::uint64_t i = 0; i < 400; ++i) {
    y = (*device)->read(i).pose.p[1];
    (*device)->write({});
    std::this_thread::sleep_for(200us);
  }
  EXPECT_LT(y, 0.035);  // it went down from 40 mm
}

}  // namespace
}  // namespace palpate
