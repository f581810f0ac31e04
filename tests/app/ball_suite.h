#pragma once
/// A test suite on one case of a ball in `bone`, made once: making it is the slow part.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/app/program_run.h"

namespace palpate::test {

class BallSuite : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new TempFolder;
    made = makeBallCase(*folder / "case");
  }
  static void TearDownTestSuite() {
    delete folder;
    folder = nullptr;
  }
  void SetUp() override { ASSERT_TRUE(made); }
  static std::string at(const std::string& name) { return (*folder / name).string(); }

  static inline TempFolder* folder = nullptr;
  static inline bool made = false;
};

}  // namespace palpate::test
