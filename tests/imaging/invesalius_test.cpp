#include "imaging/invesalius.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "imaging/archive.h"
#include "tests/imaging/archive_samples.h"
#include "tests/imaging/demo_files.h"
#include "tests/imaging/volume_samples.h"

namespace palpate {
namespace {

using test::TestFolder;

// The same CT, by independent tools (reference.json of the shared test data).
constexpr const char* kCraniumSha =
    "5ab64135b8b6ecd8115569b35ba1ee15e62949ace083165a22205641e9c309a7";

TEST(Invesalius, CraniumEqualsItsReference) {
  PALPATE_NEEDS(test::demoCt(), "Debian package invesalius-examples");
  const auto scan = importScan({.path = test::demoCt()});
  ASSERT_TRUE(scan) << sentence(scan.error());
  const Volume& v = scan->volume;
  EXPECT_EQ(v.geometry.dims, (std::array<std::int32_t, 3>{256, 256, 108}));
  EXPECT_EQ(v.type, VoxelType::Int16);
  EXPECT_EQ(v.modality, "CT");
  EXPECT_EQ(voxelsSha256(v), kCraniumSha);
  EXPECT_EQ(std::count_if(v.int16.begin(), v.int16.end(), [](auto hu) { return hu >= 300; }),
            441114);
  GridGeometry reference;  // as the same CT says as DICOM
  reference.dims = {256, 256, 108};
  reference.spacing = Eigen::Vector3d(0.957031, 0.957031, 1.5) * 1e-3;
  reference.X_PV.translation() = Eigen::Vector3d(-122.021477, -122.021477, -80.25) * 1e-3;
  EXPECT_LT(v.geometry.cornerDistance(reference), 1e-6);  // 0.001 mm
  ASSERT_EQ(scan->warnings.size(), 1U);
  EXPECT_EQ(scan->warnings[0],
            "The project stores no position in the patient: the volume is centred on the origin.");
  EXPECT_FALSE(scan->patientName.has_value());
  EXPECT_TRUE(scan->pseudonym.starts_with("Case-")) << scan->pseudonym;
}

TEST(Invesalius, CraniumAsAProjectAndAsDicomIsOneVolume) {
  PALPATE_NEEDS(test::demoCt(), "Debian package invesalius-examples");
  PALPATE_NEEDS(test::sharedData() / "series/ct_head_cranium", "shared test data");
  const auto project = importScan({.path = test::demoCt()});
  const auto dicom = importScan({.path = test::sharedData() / "series/ct_head_cranium"});
  ASSERT_TRUE(project && dicom);
  EXPECT_EQ(project->volume.int16, dicom->volume.int16);
  EXPECT_LT(project->volume.geometry.cornerDistance(dicom->volume.geometry), 1e-6);
}

TEST(Invesalius, IsListedAsOneSeries) {
  PALPATE_NEEDS(test::demoCt(), "Debian package invesalius-examples");
  const auto list = listSeries(test::demoCt());
  ASSERT_TRUE(list) << sentence(list.error());
  ASSERT_EQ(list->series.size(), 1U);
  EXPECT_EQ(list->series[0].uid, "1");
  EXPECT_EQ(list->series[0].modality, "CT");
  EXPECT_TRUE(list->series[0].importable);
  EXPECT_EQ(list->series[0].geometry.dims[2], 108);
}

std::string plist(const std::string& type, const std::string& slices) {
  return "<?xml version=\"1.0\"?><plist version=\"1.0\"><dict><key>matrix</key><dict>"
         "<key>dtype</key><string>" +
         type +
         "</string><key>filename</key><string>../matrix.dat</string><key>shape</key><array>"
         "<integer>" +
         slices +
         "</integer><integer>2</integer><integer>3</integer></array></dict><key>modality</key>"
         "<string>CT</string><key>spacing</key><array><real>1</real><real>2</real><real>3</real>"
         "</array></dict></plist>";
}

std::string voxels(int count) {
  std::string bytes;
  for (std::int16_t v = 0; v < count; ++v) bytes.append(reinterpret_cast<const char*>(&v), 2);
  return bytes;
}

TEST(Invesalius, RowsAreFlipped) {
  TestFolder folder;
  test::writeArchive(folder / "p.inv3", "tar.gz",
                     {{"t/main.plist", plist("int16", "2")}, {"t/matrix.dat", voxels(12)}});
  const auto scan = importScan({.path = folder / "p.inv3"});
  ASSERT_TRUE(scan) << sentence(scan.error());
  EXPECT_EQ(scan->volume.int16, (std::vector<std::int16_t>{3, 4, 5, 0, 1, 2, 9, 10, 11, 6, 7, 8}));
  const Eigen::Vector3d origin_mm = scan->volume.geometry.X_PV.translation() * 1e3;
  EXPECT_LT((origin_mm - Eigen::Vector3d(-1, -1, -1.5)).norm(), 1e-12);
}

TEST(Invesalius, MatrixCutShortIsRefused) {
  TestFolder folder;
  test::writeArchive(folder / "p.inv3", "tar.gz",
                     {{"t/main.plist", plist("int16", "2")}, {"t/matrix.dat", voxels(7)}});
  const auto scan = importScan({.path = folder / "p.inv3"});
  ASSERT_FALSE(scan);
  EXPECT_EQ(
      sentence(scan.error()),
      "The voxels of the InVesalius project are cut short. File: " + (folder / "p.inv3").string() +
          ". Field: matrix.dat. Found: 14 bytes. Expected: 24 bytes. Copy the project again "
          "from where it came.");
}

TEST(Invesalius, MatrixLargerThanStatedIsRefused) {
  TestFolder folder;
  test::writeArchive(folder / "p.inv3", "tar.gz",
                     {{"t/main.plist", plist("int16", "2")}, {"t/matrix.dat", voxels(13)}});
  const auto scan = importScan({.path = folder / "p.inv3"});
  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().message, "A part of the archive is larger than it states.");
}

TEST(Invesalius, WrongFieldsAreNamed) {
  TestFolder folder;
  test::writeArchive(folder / "p.inv3", "tar.gz",
                     {{"t/main.plist", plist("float64", "2")}, {"t/matrix.dat", voxels(12)}});
  const auto type = importScan({.path = folder / "p.inv3"});
  ASSERT_FALSE(type);
  EXPECT_EQ(sentence(type.error()),
            "The InVesalius project cannot be read. File: " + (folder / "p.inv3").string() +
                ". Field: main.plist: matrix, dtype. Found: float64. Expected: int16. Open the "
                "project in InVesalius and save it again.");
  test::writeArchive(folder / "p.inv3", "tar.gz",
                     {{"t/main.plist", plist("int16", "-4")}, {"t/matrix.dat", voxels(12)}});
  const auto shape = importScan({.path = folder / "p.inv3"});
  ASSERT_FALSE(shape);
  EXPECT_EQ(shape.error().field, "main.plist: matrix, shape");
  test::writeArchive(folder / "p.inv3", "tar.gz",
                     {{"t/main.plist", "no xml"}, {"t/matrix.dat", voxels(12)}});
  const auto xml = importScan({.path = folder / "p.inv3"});
  ASSERT_FALSE(xml);
  EXPECT_EQ(xml.error().message, "The InVesalius project cannot be read.");
}

TEST(Invesalius, HalfOfTheFileIsRefused) {
  PALPATE_NEEDS(test::demoCt(), "Debian package invesalius-examples");
  TestFolder folder;
  const std::string bytes = test::readBytes(test::demoCt());
  for (const double share : {0.9, 0.5, 0.1, 0.01}) {
    const auto size = static_cast<std::size_t>(static_cast<double>(bytes.size()) * share);
    // Surfaces and masks come after the voxels: only a cut before their end matters.
    test::writeBytes(folder / "half.inv3", bytes.substr(0, size));
    const auto scan = importScan({.path = folder / "half.inv3"});
    if (scan) {
      EXPECT_EQ(voxelsSha256(scan->volume), kCraniumSha) << share;
    } else {
      EXPECT_EQ(scan.error().kind, ErrorKind::InputRefused);
      EXPECT_EQ(sentence(scan.error()),
                "The archive is damaged or cut short. File: " + (folder / "half.inv3").string() +
                    ". Copy it again from where it came, or unpack it and import the folder.");
    }
  }
}

TEST(Archive, MembersNeverChooseWhereTheyLand) {
  TestFolder folder;
  test::writeArchive(folder / "a.tar", "tar",
                     {{"../outside", "x"}, {"/tmp/palpate-absolute", "y"}, {"in/side", "z"}});
  std::filesystem::create_directory(folder / "to");
  const auto done = unpackArchive(folder / "a.tar", folder / "to");
  ASSERT_TRUE(done) << sentence(done.error());
  EXPECT_EQ(test::filesIn(folder / "to"), 3U);
  EXPECT_FALSE(std::filesystem::exists(folder / "outside"));
  EXPECT_FALSE(std::filesystem::exists("/tmp/palpate-absolute"));
}

TEST(Archive, LimitsAreKept) {
  TestFolder folder;
  test::writeArchive(folder / "a.zip", "zip",
                     {{"a", std::string(100'000, 'x')}, {"b", std::string(100'000, 'y')}});
  std::filesystem::create_directory(folder / "to");
  const auto bytes = unpackArchive(folder / "a.zip", folder / "to", {.bytes = 150'000});
  ASSERT_FALSE(bytes);
  EXPECT_EQ(bytes.error().message, "The archive unpacks to more than Palpate accepts.");
  std::filesystem::create_directory(folder / "to2");
  const auto members = unpackArchive(folder / "a.zip", folder / "to2", {.members = 1});
  ASSERT_FALSE(members);
  EXPECT_EQ(members.error().message, "The archive holds more files than Palpate accepts.");
}

TEST(Archive, PrivateFolderIsPrivateAndGoes) {
  std::filesystem::path path;
  {
    const auto folder = PrivateFolder::make();
    ASSERT_TRUE(folder);
    path = folder->path();
    EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms::owner_all);
    test::writeBytes(path / "x", "x");
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace palpate
