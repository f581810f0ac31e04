#include "core/base/whole_file.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <iterator>
#include <string>

namespace palpate {
namespace {

namespace fs = std::filesystem;

class WholeFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("palpate-whole-file-" + std::to_string(::getpid()) + "-" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string read(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] std::ptrdiff_t entries() const {
    return std::distance(fs::directory_iterator(folder_), {});
  }

  fs::path folder_;
};

TEST_F(WholeFileTest, ReplacesTheOldContentAndLeavesNothingBeside) {
  ASSERT_TRUE(writeWholeFile(folder_ / "a.txt", "old"));
  ASSERT_TRUE(writeWholeFile(folder_ / "a.txt", "new"));
  EXPECT_EQ(read(folder_ / "a.txt"), "new");
  EXPECT_EQ(entries(), 1);
}

TEST_F(WholeFileTest, WhatIsNotCommittedLeavesTheOldFileAlone) {
  ASSERT_TRUE(writeWholeFile(folder_ / "a.txt", "old"));
  {
    auto whole = WholeFile::beside(folder_ / "a.txt");
    ASSERT_TRUE(whole);
    std::ofstream(whole->hiddenName()) << "half";
  }
  EXPECT_EQ(read(folder_ / "a.txt"), "old");
  EXPECT_EQ(entries(), 1);
}

TEST_F(WholeFileTest, ALinkKeepsPointingWhereItDid) {
  ASSERT_TRUE(writeWholeFile(folder_ / "target.txt", "old"));
  fs::create_symlink(folder_ / "target.txt", folder_ / "link.txt");
  ASSERT_TRUE(writeWholeFile(folder_ / "link.txt", "new"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.txt"));
  EXPECT_EQ(read(folder_ / "target.txt"), "new");
}

TEST_F(WholeFileTest, AFullDeviceIsAMachineErrorThatSaysSo) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "this machine has no /dev/full";
  const auto written = writeWholeFile("/dev/full", "x");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, ErrorKind::Machine);
  EXPECT_EQ(sentence(written.error()),
            "The output could not be written: No space left on device. File: /dev/full. "
            "Free space on the disk or choose another place; nothing was left behind.");
}

TEST_F(WholeFileTest, APathThroughAFileIsRefusedBeforeAndAtWriting) {
  ASSERT_TRUE(writeWholeFile(folder_ / "file", "x"));
  const fs::path through = folder_ / "file" / "b.txt";
  EXPECT_FALSE(writeWholeFile(through, "y"));
  const auto possible = checkWritable(through);
  ASSERT_FALSE(possible);
  EXPECT_EQ(possible.error().message, "The output could not be written: Not a directory.");
  EXPECT_TRUE(checkWritable(folder_ / "not" / "yet" / "there"));
}

}  // namespace
}  // namespace palpate
