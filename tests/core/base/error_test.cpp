#include "core/base/error.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(Error, SentenceNamesWhatAppliesInOneFixedOrder) {
  const Error error = inputRefused("The threshold selects nothing.")
                          .inFile("case/volume.mha")
                          .inField("threshold")
                          .butFound("9000 to 9001")
                          .wants("a range within -1024 to 2986")
                          .advise("Choose a range inside the volume's values.");
  EXPECT_EQ(sentence(error),
            "The threshold selects nothing. File: case/volume.mha. Field: threshold. "
            "Found: 9000 to 9001. Expected: a range within -1024 to 2986. "
            "Choose a range inside the volume's values.");
}

TEST(Error, ExitCodesAreThoseOfTheInterface) {
  EXPECT_EQ(exitCode(ErrorKind::CheckFailed), 1);
  EXPECT_EQ(exitCode(ErrorKind::Usage), 2);
  EXPECT_EQ(exitCode(ErrorKind::InputRefused), 3);
  EXPECT_EQ(exitCode(ErrorKind::Machine), 4);
  EXPECT_EQ(exitCode(ErrorKind::Cancelled), 5);
}

}  // namespace
}  // namespace palpate
