#include "imaging/invesalius.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <iostream>

#include "imaging/case_folder.h"
#include "imaging/segmentation.h"
#include "imaging/surface.h"
#include "tests/imaging/demo_files.h"

namespace palpate {
namespace {

constexpr const char* kCraniumSha =
    "5ab64135b8b6ecd8115569b35ba1ee15e62949ace083165a22205641e9c309a7";

TEST(Invesalius, CraniumEqualsItsReference) {
  PALPATE_NEEDS(test::demoCt(), "Debian package invesalius-examples");
  const auto scan = importScan({.path = test::demoCt(), .seriesUid = {}});
  ASSERT_TRUE(scan) << sentence(scan.error());
  const Volume& v = scan->volume;
  EXPECT_EQ(v.geometry.dims, (std::array<std::int32_t, 3>{256, 256, 108}));
  EXPECT_EQ(voxelsSha256(v), kCraniumSha);
  EXPECT_EQ(std::count_if(v.int16.begin(), v.int16.end(), [](auto hu) { return hu >= 300; }),
            441114);
  GridGeometry reference;  // as the same CT says as DICOM
  reference.dims = {256, 256, 108};
  reference.spacing = Eigen::Vector3d(0.957031, 0.957031, 1.5) * 1e-3;
  reference.X_PV.translation() = Eigen::Vector3d(-122.021477, -122.021477, -80.25) * 1e-3;
  EXPECT_LT(v.geometry.cornerDistance(reference), 1e-6);  // 0.001 mm
}

TEST(Chain, Times) {
  PALPATE_NEEDS(test::demoCt(), "Debian package invesalius-examples");
  const auto now = [] { return std::chrono::steady_clock::now(); };
  const auto ms = [](auto a, auto b) {
    return std::chrono::duration<double, std::milli>(b - a).count();
  };
  test::TestFolder folder;
  auto t0 = now();
  const auto scan = importScan({.path = test::demoCt(), .seriesUid = {}});
  auto t1 = now();
  const auto wrote = writeNewCase(folder / "case", *scan);
  ASSERT_TRUE(wrote) << sentence(wrote.error());
  auto t2 = now();
  auto vol = readCaseVolume(folder / "case");
  ASSERT_TRUE(vol) << sentence(vol.error());
  auto t3 = now();
  auto labels = segment(*vol, nullptr, 1, {.range = *presetRange("ct-bone", *vol)});
  ASSERT_TRUE(labels) << sentence(labels.error());
  auto t4 = now();
  const auto wl = writeCaseLabels(folder / "case", *labels,
                                  {LabelInfo{}.name.empty() ? LabelInfo{"bone"} : LabelInfo{}});
  ASSERT_TRUE(wl) << sentence(wl.error());
  auto t5 = now();
  auto mesh = meshLabel(*labels, 1, 1);
  ASSERT_TRUE(mesh) << sentence(mesh.error());
  auto t6 = now();
  auto mesh2 = meshLabel(*labels, 1, 2);
  auto t7 = now();
  std::size_t tri = 0, tri2 = 0;
  for (auto& c : *mesh) tri += c.triangles.size() / 3;
  for (auto& c : *mesh2) tri2 += c.triangles.size() / 3;
  std::cout << "import " << ms(t0, t1) << " case " << ms(t1, t2) << " read " << ms(t2, t3)
            << " segment " << ms(t3, t4) << " labels " << ms(t4, t5) << " mesh1 " << ms(t5, t6)
            << " (" << tri << ") mesh2 " << ms(t6, t7) << " (" << tri2 << ")\n";
}

}  // namespace
}  // namespace palpate
