#include "core/base/hexadecimal.h"

#include <gtest/gtest.h>

#include <array>

namespace palpate {
namespace {

TEST(Hexadecimal, TwoSmallDigitsAByte) {
  EXPECT_EQ(hexadecimal(std::array<std::uint8_t, 4>{0, 9, 0xAF, 255}), "0009afff");
  EXPECT_EQ(hexadecimal({}), "");
}

}  // namespace
}  // namespace palpate
