#include "core/base/large_array.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <vector>

namespace palpate {
namespace {

using Array = LargeArray<std::uint32_t>;

// On the heap, and above 2 MiB on pages of its own.
constexpr std::size_t kCounts[] = {
    1, 15, 1000, (std::size_t{2} << 20) / 4 - 16, (std::size_t{2} << 20) / 4 - 15, 700000};

Array counting(std::size_t count) {
  Array array;
  array.resize(count);
  std::iota(array.begin(), array.end(), 5U);
  return array;
}

TEST(LargeArray, ACopyIsItsOwn) {
  for (const std::size_t count : kCounts) {
    const Array from = counting(count);
    Array copy = from;
    EXPECT_EQ(copy, from);
    EXPECT_NE(copy.data(), from.data());
    copy[count - 1] = 1;
    EXPECT_EQ(from.back(), 5U + count - 1);
    EXPECT_FALSE(copy == from);
    copy = from;
    EXPECT_EQ(copy, from);
    Array& self = copy;
    copy = self;
    EXPECT_EQ(copy, from);
    EXPECT_EQ(copy.bytes(), 4 * count);
  }
  const Array none = Array(Array());
  EXPECT_TRUE(none.empty());
}

TEST(LargeArray, AMoveTakesTheMemoryAlong) {
  for (const std::size_t count : kCounts) {
    Array from = counting(count);
    const std::uint32_t* at = from.data();
    Array to = std::move(from);
    EXPECT_EQ(to.data(), at);
    EXPECT_EQ(to, counting(count));
    Array other = counting(3);
    other = std::move(to);
    EXPECT_EQ(other.data(), at);
    EXPECT_EQ(other.size(), count);
  }
}

TEST(LargeArray, GrowthKeepsTheValuesAndNewOnesAreZero) {
  for (const std::size_t count : kCounts) {
    Array array = counting(count);
    array.resize(count + 12345);
    for (std::size_t i = 0; i < array.size(); ++i) {
      ASSERT_EQ(array[i], i < count ? static_cast<std::uint32_t>(5 + i) : 0U) << i;
    }
    // What was cut off does not come back.
    array.assign(count + 100, 9);
    array.resize(count);
    array.resize(count + 100);
    EXPECT_EQ(array[count - 1], 9U);
    for (std::size_t i = count; i < array.size(); ++i) ASSERT_EQ(array[i], 0U) << i;
    array.reserve(3 * count + 1000);
    EXPECT_EQ(array.size(), count + 100);
    EXPECT_EQ(array[count - 1], 9U);
  }
}

TEST(LargeArray, PushAndAppendDoWhatAVectorDoes) {
  std::vector<std::uint32_t> expected;
  Array array;
  for (std::uint32_t i = 0; i < 3000; ++i) {
    array.push_back(i * 7);
    expected.push_back(i * 7);
    if (i % 100 == 0) {
      const std::uint32_t some[] = {i, 1, 2};
      array.append(some, i % 300 == 0 ? 0 : 3);
      if (i % 300 != 0) expected.insert(expected.end(), {i, 1, 2});
    }
    array.push_back(array[0]);  // of itself, at a place that growth may move
    expected.push_back(expected[0]);
  }
  ASSERT_EQ(array.size(), expected.size());
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), array.begin()));
}

// Sanitizers watch the reads.
TEST(LargeArray, TheSlackBehindTheEndCanBeRead) {
  for (const std::size_t count : kCounts) {
    for (Array array : {counting(count), Array(counting(count))}) {
      std::uint32_t sum = 0;
      for (std::size_t i = 0; i < Array::kSlackBytes / 4; ++i) sum += array.data()[count + i];
      EXPECT_EQ(sum, 0U);
      array.push_back(1);
      volatile std::uint32_t last = array.data()[array.size() - 1 + Array::kSlackBytes / 4];
      static_cast<void>(last);
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array.data()) % 64, 0U);
    }
  }
}

TEST(LargeArray, AViewReadsItsOwnersMemoryAndGrowsOutOfIt) {
  auto owner = std::make_shared<std::vector<std::uint32_t>>(100 + 16, 3U);
  const std::weak_ptr<std::vector<std::uint32_t>> alive = owner;
  Array view = Array::view(owner->data(), 100, owner);
  EXPECT_EQ(view.size(), 100U);
  EXPECT_EQ(view.data(), owner->data());
  view[7] = 8;
  EXPECT_EQ((*owner)[7], 8U);
  const Array copy = view;  // own memory
  view[8] = 9;
  EXPECT_EQ(copy[8], 3U);
  view.push_back(4);  // leaves the owner
  EXPECT_NE(view.data(), owner->data());
  view[9] = 10;
  EXPECT_EQ((*owner)[9], 3U);
  EXPECT_EQ((*owner)[100], 3U);
  EXPECT_EQ(view[7], 8U);
  EXPECT_EQ(view.back(), 4U);
  {
    Array second = Array::view(owner->data(), 100, owner);
    owner.reset();
    EXPECT_FALSE(alive.expired());
    EXPECT_EQ(second[8], 9U);
    Array third = std::move(second);
    EXPECT_EQ(third[7], 8U);
  }
  EXPECT_TRUE(alive.expired());
}

}  // namespace
}  // namespace palpate
