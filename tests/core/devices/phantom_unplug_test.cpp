/// Two Phantoms of which one fails, and a cable that is pulled while the hand feels something.

#include <gmock/gmock.h>

#include "tests/core/devices/fake_hd/fake_machine.h"

namespace palpate::test {
namespace {

using fake_hd::Fault;
using hd::DriverState;

constexpr int kForGood = 1000000;  // ticks

class PhantomUnplugTest : public FakeMachine {};

TEST_F(PhantomUnplugTest, ReconnectingOneLeavesTheOtherAtWork) {
  fake_hd::DeviceSetup left, right;
  left.name = "Left";
  right.name = "Right";
  const int l = configure(left), r = configure(right);
  Phantom a(options({"Left"})), b(options({"Right"}));
  ASSERT_TRUE(a.open());
  ASSERT_TRUE(b.open());
  ASSERT_TRUE(reaches(a, DriverState::Ready));
  ASSERT_TRUE(reaches(b, DriverState::Ready));
  Owner ownerA(a), ownerB(b);
  ownerA.pushForce(1, 0, 0);
  ownerB.pushForce(0, 2, 0);
  ownerA.start();
  ownerB.start();
  ASSERT_TRUE(eventually([&] { return appliedForce(l) == 1.0 && appliedForce(r) == 2.0; }));
  fake().inject(l, Fault::Lost, 0, 2, kForGood);
  ASSERT_TRUE(reaches(a, DriverState::Lost));
  for (int attempt = 0; attempt < 3; ++attempt) {
    fake().failInit(l, 0x302, 1);
    EXPECT_FALSE(a.reconnect());
    // The other paused without force, kept its device and goes on.
    const std::uint64_t ticks = ownerB.ticks();
    ASSERT_TRUE(eventually([&] { return appliedForce(r) == 2.0 && ownerB.ticks() > ticks + 5; }));
    EXPECT_EQ(b.status().state, DriverState::Ready);
    EXPECT_EQ(b.status().errors, 0u);
    EXPECT_EQ(a.status().state, DriverState::Lost);
  }
  fake().clearFaults(l);
  ASSERT_TRUE(a.reconnect());
  ASSERT_TRUE(reaches(a, DriverState::Ready));
  EXPECT_TRUE(eventually([&] { return appliedForce(l) == 1.0 && appliedForce(r) == 2.0; }));
  EXPECT_EQ(fake().violations(), 0);
}

TEST_F(PhantomUnplugTest, OneOfTwoFaultsAndTheOtherNeverMissesItsForce) {
  fake_hd::DeviceSetup left, right;
  left.name = "Left";
  right.name = "Right";
  const int l = configure(left), r = configure(right);
  Phantom a(options({"Left"})), b(options({"Right"}));
  ASSERT_TRUE(a.open());
  ASSERT_TRUE(b.open());
  Owner ownerA(a), ownerB(b);
  ownerA.pushForce(1, 0, 0);
  ownerB.pushForce(0, 2, 0);
  ownerA.start();
  ownerB.start();
  ASSERT_TRUE(eventually([&] { return appliedForce(l) == 1.0 && appliedForce(r) == 2.0; }));
  const std::uint64_t from = fake().ticks();
  for (const unsigned code : {0x300u, 0x402u, 0x201u})
    fake().inject(l, Fault::ErrorAtEnd, static_cast<int>(code), 2, 50);
  ASSERT_TRUE(reaches(a, DriverState::Fault));
  ASSERT_TRUE(reaches(a, DriverState::Ready));
  const std::uint64_t to = fake().ticks();
  int seen = 0;
  for (const auto& record : records(r)) {
    if (record.tick <= from || record.tick >= to) continue;
    ++seen;
    EXPECT_DOUBLE_EQ(norm(record.force), 2.0) << record.tick;
  }
  EXPECT_GT(seen, 50);
  EXPECT_EQ(b.status().errors, 0u);
}

TEST_F(PhantomUnplugTest, ACablePulledUnderForceCutsItInTheSameTickAndComesBack) {
  const int device = configure({});
  fake().setTransform(device, transform(at(0.01, 0.02, 0.03)).data());
  Phantom phantom(options());
  ASSERT_TRUE(phantom.open());
  ASSERT_TRUE(reaches(phantom, DriverState::Ready));
  Owner owner(phantom);
  owner.pushForce(0, 1.5, 0);
  owner.start();
  ASSERT_TRUE(eventually([&] { return appliedForce(device) == 1.5; }));
  // The library still takes commands in the ticks that report the loss: none may be a force.
  fake().inject(device, Fault::ErrorAtBegin, 0x302, 2, 300);
  ASSERT_TRUE(reaches(phantom, DriverState::Lost));
  EXPECT_EQ(phantom.condition().state, DeviceCondition::State::Gone);
  EXPECT_EQ(owner.sample().status & kDeviceLost, kDeviceLost);
  EXPECT_DOUBLE_EQ(owner.sample().pose.p[0], 0.01);  // the last good pose
  ASSERT_TRUE(reaches(phantom, DriverState::Ready));
  ASSERT_TRUE(eventually([&] { return appliedForce(device) == 1.5; }));
  bool pulled = false;
  int without = 0;
  for (const auto& record : records(device)) {
    pulled = pulled || record.faulty;
    if (!record.faulty) continue;
    ++without;
    EXPECT_DOUBLE_EQ(norm(record.force), 0.0) << record.tick;
  }
  EXPECT_TRUE(pulled);
  EXPECT_EQ(without, 300);
  EXPECT_EQ(fake().violations(), 0);
}

}  // namespace
}  // namespace palpate::test
