#include "core/base/latest_value.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <thread>

namespace palpate {
namespace {

using Message = std::array<std::uint64_t, 32>;

Message filledWith(std::uint64_t n) {
  Message message;
  message.fill(n);
  return message;
}

TEST(LatestValue, ReaderSeesOnlyTheNewest) {
  LatestValue<int> latest;
  EXPECT_FALSE(latest.refresh());
  latest.publish(1);
  latest.publish(2);
  EXPECT_TRUE(latest.refresh());
  EXPECT_EQ(latest.value(), 2);
  EXPECT_FALSE(latest.refresh());
  EXPECT_EQ(latest.value(), 2);
}

TEST(LatestValue, NeverTearsAndNeverGoesBackUnderTwoThreads) {
  LatestValue<Message> latest;
  constexpr std::uint64_t kCount = 200000;
  std::thread writer([&latest] {
    for (std::uint64_t n = 1; n <= kCount; ++n) latest.publish(filledWith(n));
  });
  std::uint64_t last = 0;
  while (last < kCount) {
    if (!latest.refresh()) continue;
    const Message& message = latest.value();
    for (const std::uint64_t v : message) ASSERT_EQ(v, message[0]);
    ASSERT_GT(message[0], last);
    last = message[0];
  }
  writer.join();
}

}  // namespace
}  // namespace palpate
