/// The list of recent cases tells one from another.

#include <gtest/gtest.h>

#include <cstdlib>

#include "app/desktop_recent.h"
#include "imaging/case_folder.h"
#include "tests/ui/synthetic_case.h"

namespace palpate {
namespace {

TEST(RecentCases, TwoImportsOfOneScanAreToldApart) {
  char name[] = "/tmp/palpate_recent_XXXXXX";
  const std::filesystem::path folder = ::mkdtemp(name);
  ImportedScan scan;
  scan.volume = test::syntheticHead(8);
  scan.description = "Synthetic head";
  RecentCases recent(folder);
  for (const char* one : {"case-1", "case-2"}) {
    const auto written = writeNewCase(folder / one, scan);
    ASSERT_TRUE(written) << sentence(written.error());
    recent.add(folder / one);
  }
  const auto rows = recent.list();
  std::filesystem::remove_all(folder);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].title, "Synthetic head");
  EXPECT_EQ(rows[0].title, rows[1].title);
  EXPECT_TRUE(rows[0].detail.ends_with(" mm \xc2\xb7 case-2")) << rows[0].detail;
  EXPECT_TRUE(rows[1].detail.ends_with(" mm \xc2\xb7 case-1")) << rows[1].detail;
}

}  // namespace
}  // namespace palpate
