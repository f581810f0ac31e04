/// DICOM without any data but ours: volumes written as DICOM and read back.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "imaging/import.h"
#include "tests/imaging/archive_samples.h"
#include "tests/imaging/demo_files.h"
#include "tests/imaging/dicom_bytes.h"
#include "tests/imaging/dicom_writer.h"
#include "tests/imaging/volume_samples.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using test::DicomWriterOptions;
using test::TestFolder;
using test::writeDicomSeries;

Volume sample(std::int32_t slices = 6) {
  Volume v = test::int16Volume(test::obliqueGeometry(20, 14, slices));
  v.modality = "MR";
  return v;
}

TEST(Dicom, DemoCtWrittenAndReadIsTheSameVolume) {
  PALPATE_NEEDS(test::demoCt(), "Debian package invesalius-examples");
  TestFolder folder;
  const auto project = importScan({.path = test::demoCt()});
  ASSERT_TRUE(project);
  writeDicomSeries(project->volume, folder.path());
  const auto dicom = importScan({.path = folder.path()});
  ASSERT_TRUE(dicom) << sentence(dicom.error());
  EXPECT_EQ(dicom->volume.int16, project->volume.int16);
  EXPECT_EQ(voxelsSha256(dicom->volume), voxelsSha256(project->volume));
  EXPECT_LT(dicom->volume.geometry.cornerDistance(project->volume.geometry), 1e-6);
  EXPECT_EQ(dicom->volume.modality, "CT");
  EXPECT_TRUE(dicom->warnings.empty());
  EXPECT_FALSE(dicom->lossy);
}

TEST(Dicom, ObliqueSeriesKeepsCornersAndVoxels) {
  TestFolder folder;
  const Volume v = sample();
  writeDicomSeries(v, folder.path(), {.slices = {4, 0, 5, 2, 1, 3}});
  const auto scan = importScan({.path = folder.path()});
  ASSERT_TRUE(scan) << sentence(scan.error());
  EXPECT_LT(scan->volume.geometry.cornerDistance(v.geometry), 1e-6);
  EXPECT_EQ(scan->volume.int16, v.int16);
}

class TransferSyntax : public testing::TestWithParam<const char*> {};

TEST_P(TransferSyntax, GivesTheSameVoxels) {
  TestFolder folder;
  Volume v = sample(2);
  // Twelve bits, as scanners store. On sixteen bits of noise DCMTK's JPEG-LS encoder (3.6.7) writes
  // streams that its own tools cannot read again.
  for (auto& x : v.int16) x = static_cast<std::int16_t>(x / 16);
  writeDicomSeries(v, folder.path(), {.transferSyntax = GetParam()});
  const auto scan = importScan({.path = folder.path()});
  ASSERT_TRUE(scan) << sentence(scan.error());
  EXPECT_EQ(scan->volume.int16, v.int16);
  EXPECT_FALSE(scan->lossy);
}

INSTANTIATE_TEST_SUITE_P(Lossless, TransferSyntax,
                         testing::Values("1.2.840.10008.1.2",       // implicit
                                         "1.2.840.10008.1.2.1",     // explicit
                                         "1.2.840.10008.1.2.2",     // big-endian
                                         "1.2.840.10008.1.2.1.99",  // deflated
                                         "1.2.840.10008.1.2.5",     // RLE
                                         "1.2.840.10008.1.2.4.57",  // JPEG lossless
                                         "1.2.840.10008.1.2.4.70",  // JPEG lossless, SV1
                                         "1.2.840.10008.1.2.4.80"   // JPEG-LS lossless
                                         ));

TEST(Dicom, RescaleIsAppliedPerSlice) {
  TestFolder folder;
  Volume v = sample(4);
  for (auto& x : v.int16) x = static_cast<std::int16_t>(x / 4 * 2);
  writeDicomSeries(v, folder.path(), {.slope = 2.0, .intercept = -1000.0, .slices = {0, 1}});
  writeDicomSeries(v, folder.path(), {.slices = {2, 3}, .filePrefix = "other"});
  const auto scan = importScan({.path = folder.path()});
  ASSERT_TRUE(scan) << sentence(scan.error());
  EXPECT_EQ(scan->volume.int16, v.int16);
}

TEST(Dicom, FractionsBecomeFloat32) {
  TestFolder folder;
  Volume v = sample(2);
  writeDicomSeries(v, folder.path());
  Volume half = v;
  for (auto& x : half.int16) x = static_cast<std::int16_t>(x / 3);
  writeDicomSeries(half, folder / "half", {.seriesUid = "2.25.7", .slope = 0.5});
  const auto scan = importScan({.path = folder / "half"});
  ASSERT_TRUE(scan) << sentence(scan.error());
  // Stored as value/0.5 in 16 bits: still whole, so int16.
  EXPECT_EQ(scan->volume.type, VoxelType::Int16);
}

TEST(Dicom, TiltIsRefusedAndRepairedOnRequest) {
  TestFolder folder;
  // A field that is linear in the patient: f = 3x + 5y - 7z + 40 (mm). Linear interpolation must
  // give it back exactly but for rounding to whole values, wherever slices reach.
  Volume v;
  v.geometry.dims = {24, 30, 10};
  v.geometry.spacing = Eigen::Vector3d(1.0, 1.0, 2.0) * 1e-3;
  v.int16.resize(v.geometry.voxelCount());
  const auto shift = [](int k) { return Eigen::Vector3d(0, 0.5 * k, 0); };
  const auto field = [](const Eigen::Vector3d& p_mm) {
    return 3 * p_mm.x() + 5 * p_mm.y() - 7 * p_mm.z() + 40;
  };
  for (int k = 0; k < 10; ++k)
    for (int j = 0; j < 30; ++j)
      for (int i = 0; i < 24; ++i) {
        const Eigen::Vector3d p = v.geometry.centre_V(i, j, k) * 1e3 + shift(k);
        v.int16[v.geometry.index(i, j, k)] = static_cast<std::int16_t>(std::lround(field(p)));
      }
  writeDicomSeries(v, folder.path(), {.shift_mm = shift});
  const auto refused = importScan({.path = folder.path()});
  ASSERT_FALSE(refused);
  EXPECT_EQ(sentence(refused.error()),
            "The series is not a regular box: its slices are sheared against their normal by 14.0 "
            "degrees (gantry tilt), up to 4.5 mm. File: " +
                folder.path().string() +
                ". Field: gantry tilt. Expected: slices at even distances, straight above each "
                "other. Import it with --repair tilt to have it resampled to a regular grid.");
  ImportRequest request{.path = folder.path()};
  request.repairSpacing = true;
  EXPECT_FALSE(importScan(request)) << "leave for spacing is not leave for tilt";
  request.repairTilt = true;
  const auto scan = importScan(request);
  ASSERT_TRUE(scan) << sentence(scan.error());
  ASSERT_EQ(scan->repairs.size(), 1U);
  EXPECT_EQ(
      scan->repairs[0],
      "Resampled to a regular grid of 10 slices 2 mm apart; before, its slices are sheared "
      "against their normal by 14.0 degrees (gantry tilt), up to 4.5 mm. Largest displacement "
      "of a slice: 4.50 mm.");
  const GridGeometry& g = scan->volume.geometry;
  EXPECT_EQ(g.dims, (std::array<std::int32_t, 3>{24, 35, 10}));
  std::size_t compared = 0;
  for (int k = 0; k < g.dims[2]; ++k)
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i) {
        const Eigen::Vector3d p = g.X_PV * g.centre_V(i, j, k) * 1e3;
        const double row = p.y() - 0.5 * k;
        if (row < 0.0 || row > 29.0) continue;  // beyond the slice: filled with air
        EXPECT_NEAR(scan->volume.int16[g.index(i, j, k)], field(p), 1.01);
        ++compared;
      }
  EXPECT_GT(compared, 24U * 29U * 10U - 500U);
}

TEST(Dicom, MissingSliceIsRefusedAndFilledOnRequest) {
  TestFolder folder;
  Volume v = sample(7);
  for (std::size_t i = 0; i < v.int16.size(); ++i) {
    const auto slice = static_cast<int>(i / (20 * 14));
    v.int16[i] = static_cast<std::int16_t>(slice * 100);
  }
  writeDicomSeries(v, folder.path(), {.slices = {0, 1, 2, 4, 5, 6}});
  const auto refused = importScan({.path = folder.path()});
  ASSERT_FALSE(refused);
  EXPECT_EQ(
      refused.error().message,
      "The series is not a regular box: its slices are 1.3 to 2.6 mm apart (uneven spacing or "
      "missing slices).");
  EXPECT_EQ(refused.error().advice,
            "Import it with --repair spacing to have it resampled to a regular grid.");
  ImportRequest request{.path = folder.path()};
  request.repairSpacing = true;
  const auto scan = importScan(request);
  ASSERT_TRUE(scan) << sentence(scan.error());
  EXPECT_LT(scan->volume.geometry.cornerDistance(v.geometry), 1e-6);
  EXPECT_EQ(scan->volume.int16, v.int16) << "linear from slice to slice, so filled exactly";
}

TEST(Dicom, SeveralSeriesAreRefusedWithTheListAndChosenByUid) {
  TestFolder folder;
  const Volume v = sample(3);
  const Volume w = test::int16Volume(test::obliqueGeometry(8, 8, 4), 99);
  writeDicomSeries(v, folder / "a", {.seriesUid = "2.25.1"});
  writeDicomSeries(w, folder / "b", {.seriesUid = "2.25.2"});
  const auto refused = importScan({.path = folder.path()});
  ASSERT_FALSE(refused);
  EXPECT_EQ(sentence(refused.error()),
            "There are several volumes in there. File: " + folder.path().string() +
                ". Field: series. Found: 2.25.1 (MR, 3 slices); 2.25.2 (CT, 4 slices). Expected: "
                "one series. Name one with --series UID.");
  const auto one = importScan({.path = folder.path(), .seriesUid = "2.25.2"});
  ASSERT_TRUE(one) << sentence(one.error());
  EXPECT_EQ(one->volume.int16, w.int16);
  const auto none = importScan({.path = folder.path(), .seriesUid = "9"});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().message, "There is no such series in there.");
  const auto list = listSeries(folder.path());
  ASSERT_TRUE(list);
  ASSERT_EQ(list->series.size(), 2U);
  EXPECT_EQ(list->series[0].files, 3U);
  EXPECT_EQ(list->series[1].geometry.dims, w.geometry.dims);
}

TEST(Dicom, ScoutsAreInTheListOfSeveralVolumes) {
  TestFolder folder;
  Volume scout = sample(1);
  scout.modality = "CT";
  writeDicomSeries(sample(3), folder / "a", {.seriesUid = "2.25.1"});
  writeDicomSeries(scout, folder / "b",
                   {.seriesUid = "2.25.2", .imageType = "ORIGINAL\\PRIMARY\\LOCALIZER"});
  EXPECT_TRUE(importScan({.path = folder.path()})) << "the scout is not meant";
  EXPECT_TRUE(importScan({.path = folder.path(), .seriesUid = "2.25.2"}))
      << "by its own name it is";
  writeDicomSeries(sample(4), folder / "c", {.seriesUid = "2.25.3"});
  const auto refused = importScan({.path = folder.path()});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().found,
            "2.25.1 (MR, 3 slices); 2.25.2 (CT, 1 slice), a scout; 2.25.3 (MR, 4 slices)");
}

TEST(Dicom, AUidOfSeveralSingleImagesIsRefusedWithTheList) {
  TestFolder folder;
  Volume a = sample(1);
  Volume b = a;
  b.geometry.X_PV.linear() = Eigen::Matrix3d::Identity();
  writeDicomSeries(a, folder.path());
  writeDicomSeries(b, folder.path(), {.filePrefix = "other"});
  for (const auto& uid : {std::optional<std::string>(), std::optional<std::string>("2.25.1001")}) {
    const auto refused = importScan({.path = folder.path(), .seriesUid = uid});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message, "There are several volumes in there.");
    EXPECT_EQ(refused.error().found, "2.25.1001#1 (MR, 1 slice); 2.25.1001#2 (MR, 1 slice)");
  }
  const auto second = importScan({.path = folder.path(), .seriesUid = "2.25.1001#2"});
  ASSERT_TRUE(second) << sentence(second.error());
  EXPECT_LT(second->volume.geometry.cornerDistance(b.geometry), 1e-6);
  // A stack beside them is what their UID means.
  Volume c = sample(3);
  c.geometry.X_PV.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()).toRotationMatrix();
  writeDicomSeries(c, folder.path(), {.filePrefix = "stack"});
  const auto stack = importScan({.path = folder.path(), .seriesUid = "2.25.1001"});
  ASSERT_TRUE(stack) << sentence(stack.error());
  EXPECT_EQ(stack->volume.geometry.dims[2], 3);
}

TEST(Dicom, ANamedSeriesWithoutImagesIsThereAndHoldsNone) {
  TestFolder folder;
  writeDicomSeries(sample(3), folder.path(), {.seriesUid = "2.25.1"});
  // Of series 2.25.1001, without rows.
  std::string object = test::DicomBytes().file();
  const std::string rows = test::number16(0x00280010, 8);
  object.replace(object.find(rows), rows.size(), test::number16(0x00280009, 8));
  test::writeBytes(folder / "object", object);
  const auto scan = importScan({.path = folder.path(), .seriesUid = "2.25.1001"});
  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().message, "The series cannot become a volume: it holds no image (CT).");
  EXPECT_EQ(scan.error().field, "SOPClassUID");
  EXPECT_EQ(scan.error().found, "CTImageStorage");
}

TEST(Dicom, IdenticalCopiesAreLeftOutAndConflictsRefused) {
  TestFolder folder;
  Volume v = sample(4);
  writeDicomSeries(v, folder.path());
  writeDicomSeries(v, folder.path(), {.slices = {2}, .filePrefix = "copy"});
  const auto scan = importScan({.path = folder.path()});
  ASSERT_TRUE(scan) << sentence(scan.error());
  EXPECT_EQ(scan->volume.int16, v.int16);
  ASSERT_EQ(scan->warnings.size(), 1U);
  EXPECT_EQ(scan->warnings[0], "1 identical copy of an image was left out.");
  v.int16[2 * 20 * 14] = static_cast<std::int16_t>(v.int16[2 * 20 * 14] ^ 1);
  writeDicomSeries(v, folder.path(), {.slices = {2}, .filePrefix = "other"});
  const auto refused = importScan({.path = folder.path()});
  ASSERT_FALSE(refused);
  EXPECT_EQ(
      refused.error().message,
      "The series cannot become a volume: different images lie at the same place: copy00000 and "
      "other00000 (5 different images at 4 places).")
      << "the copy counts once";
}

TEST(Dicom, ConflictsAreNamedWithoutThePatient) {
  TestFolder folder;
  Volume v = sample(2);
  const DicomWriterOptions first{.patientName = "Quince^Medlar", .filePrefix = "MEDLAR"};
  writeDicomSeries(v, folder / "a", first);
  v.int16[0] = static_cast<std::int16_t>(v.int16[0] ^ 1);
  writeDicomSeries(v, folder / "b", {.patientName = "Quince^Medlar", .slices = {0}});
  EXPECT_EQ(importScan({.path = folder.path()}).error().found, "the same in file 1 and image00000");
  fs::remove_all(folder / "a");
  writeDicomSeries(sample(2), folder / "a",
                   {.patientName = "Quince^Medlar", .filePrefix = "A\x1B[2J"});
  EXPECT_EQ(importScan({.path = folder.path()}).error().found,
            "the same in A?[2J00000 and image00000");
  fs::remove_all(folder / "a");
  writeDicomSeries(sample(2), folder / "a", {.patientName = "Quince^Medlar"});
  EXPECT_EQ(importScan({.path = folder.path()}).error().found,
            "the same in two files called image00000");
}

TEST(Dicom, ConflictsInAnArchiveAreNamedAsInTheArchive) {
  TestFolder images;
  Volume v = sample(2);
  writeDicomSeries(v, images.path());
  v.int16[0] = static_cast<std::int16_t>(v.int16[0] ^ 1);
  writeDicomSeries(v, images.path(), {.slices = {0}, .filePrefix = "other"});
  std::vector<std::pair<std::string, std::string>> members{{"folder/read.me", "text"}};
  for (const char* name : {"image00000", "image00611", "other00000"}) {
    members.emplace_back(std::string("folder/") + name, test::readBytes(images / name));
  }
  TestFolder folder;
  test::writeArchive(folder / "study", "tar.gz", members);
  const auto refused = importScan({.path = folder / "study"});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message,
            "The series cannot become a volume: different images lie at the same place: image00000 "
            "and other00000 (3 different images at 2 places).");
}

TEST(Dicom, OtherOrientationInTheSeriesIsLeftOut) {
  TestFolder folder;
  const Volume v = sample(4);
  writeDicomSeries(v, folder.path());
  GridGeometry across = v.geometry;
  across.dims = {30, 30, 1};
  across.X_PV.linear() = Eigen::Matrix3d::Identity();
  writeDicomSeries(test::int16Volume(across), folder.path(), {.filePrefix = "scout"});
  const auto scan = importScan({.path = folder.path()});
  ASSERT_TRUE(scan) << sentence(scan.error());
  EXPECT_EQ(scan->volume.int16, v.int16);
  ASSERT_EQ(scan->warnings.size(), 1U);
  EXPECT_EQ(scan->warnings[0], "Left out: 1 other image stack (scouts or other series).");
  const auto list = listSeries(folder.path());
  ASSERT_TRUE(list);
  EXPECT_EQ(list->series.size(), 2U);
}

TEST(Dicom, DamagedFileOfTheSeriesRefusesTheSeries) {
  TestFolder folder;
  writeDicomSeries(sample(5), folder.path());
  const auto last = folder / "image01833";  // the fourth written
  ASSERT_TRUE(fs::exists(last));
  test::writeBytes(last, test::readBytes(last).substr(0, 500));
  const auto scan = importScan({.path = folder.path()});
  ASSERT_FALSE(scan) << "four of five slices are not the scan";
}

TEST(Dicom, ArchivesAreOpened) {
  const Volume v = sample(3);
  TestFolder images;
  writeDicomSeries(v, images.path());
  std::vector<std::pair<std::string, std::string>> members{{"read.me", "text"}};
  for (const auto& file : fs::directory_iterator(images.path())) {
    members.emplace_back("../deep/" + file.path().filename().string(),
                         test::readBytes(file.path()));
  }
  for (const char* kind : {"zip", "tar", "tar.gz"}) {
    TestFolder folder;
    const auto file = folder / "study";
    test::writeArchive(file, kind, members);
    const auto scan = importScan({.path = file});
    ASSERT_TRUE(scan) << kind << ": " << sentence(scan.error());
    EXPECT_EQ(scan->volume.int16, v.int16) << kind;
    const auto list = listSeries(file);
    ASSERT_TRUE(list);
    EXPECT_EQ(list->skippedFiles, 1U);
    const std::string whole = test::readBytes(file);
    test::writeBytes(file, whole.substr(0, whole.size() / 2));
    EXPECT_FALSE(importScan({.path = file})) << kind << " cut short";
  }
}

/// A DICOMDIR that refers to these files.
std::string directoryOf(const std::vector<std::string>& files, std::uint32_t inUse = 0xFFFF) {
  std::vector<std::string> records{test::number16(0x00041410, 0xFFFF) +
                                   test::element(0x00041430, "CS", "PATIENT")};
  for (const std::string& file : files) {
    records.push_back(test::number16(0x00041410, inUse) + test::element(0x00041430, "CS", "IMAGE") +
                      test::element(0x00041500, "CS", file));
  }
  return test::part10(test::kExplicitVr, test::sequence(0x00041220, records));
}

TEST(Dicom, FilesThatADicomdirListsAndAreNotThereAreToldOf) {
  TestFolder folder;
  const Volume v = sample(3);
  writeDicomSeries(v, folder / "disc");
  const auto warnings = [&](const fs::path& path) {
    const auto scan = importScan({.path = path});
    EXPECT_TRUE(scan) << sentence(scan.error());
    const auto list = listSeries(path);
    EXPECT_TRUE(list);
    EXPECT_EQ(list->warnings, scan->warnings);
    return scan->warnings;
  };
  const fs::path index = folder / "disc/DICOMDIR";
  // In capitals and with a version, as discs show them.
  test::writeBytes(index, directoryOf({"IMAGE00000", "IMAGE00611;1", ".\\IMAGE01222"}));
  EXPECT_TRUE(warnings(index).empty());
  test::writeBytes(index, directoryOf({"GONE"}, 0));  // No more in use.
  EXPECT_TRUE(warnings(index).empty());
  const std::string incomplete =
      "The DICOMDIR lists 3 files, and 2 of them are not there or cannot be read: the scan may be "
      "incomplete.";
  test::writeBytes(index, directoryOf({"IMAGE00000", "DEEP\\IMAGE00611", "..\\GONE"}));
  EXPECT_EQ(warnings(index), std::vector<std::string>{incomplete});
  EXPECT_EQ(warnings(folder / "disc"), std::vector<std::string>{incomplete});
  EXPECT_EQ(warnings(folder.path()), std::vector<std::string>{incomplete});
  std::vector<std::pair<std::string, std::string>> members;
  for (const auto& file : fs::directory_iterator(folder / "disc")) {
    members.emplace_back("disc/" + file.path().filename().string(), test::readBytes(file.path()));
  }
  test::writeArchive(folder / "disc.zip", "zip", members);
  EXPECT_EQ(warnings(folder / "disc.zip"), std::vector<std::string>{incomplete});
  test::writeBytes(index, directoryOf({"IMAGE00000", "IMAGE00611"}).substr(0, 300));
  EXPECT_EQ(warnings(index),
            std::vector<std::string>{"The DICOMDIR cannot be read to its end: whether all images "
                                     "are there is not known."});
}

TEST(Dicom, NamesAreShownButNotKept) {
  TestFolder folder;
  writeDicomSeries(sample(2), folder.path(),
                   {.patientName = "Mustermann^Erika", .description = "Skull of MUSTERMANN"});
  const auto list = listSeries(folder.path());
  ASSERT_TRUE(list);
  EXPECT_EQ(list->series[0].patientName, "Mustermann^Erika");
  const auto scan = importScan({.path = folder.path()});
  ASSERT_TRUE(scan);
  EXPECT_FALSE(scan->patientName.has_value());
  EXPECT_EQ(scan->description, "") << "it held the name";
  ImportRequest request{.path = folder.path()};
  request.keepNames = true;
  EXPECT_EQ(importScan(request)->patientName, "Mustermann^Erika");
}

TEST(Dicom, AMapOfPerfusionIsNotTakenAsCt) {
  TestFolder folder;
  Volume v = sample(3);
  v.modality = "CT";
  writeDicomSeries(v, folder / "ct", {.imageType = "ORIGINAL\\PRIMARY\\AXIAL"});
  EXPECT_EQ(importScan({.path = folder / "ct"})->volume.modality, "CT");
  writeDicomSeries(v, folder / "map", {.imageType = "DERIVED\\PRIMARY\\PERFUSION\\RCBF"});
  const auto map = importScan({.path = folder / "map"});
  ASSERT_TRUE(map) << sentence(map.error());
  EXPECT_EQ(map->volume.modality, "OT");
  ASSERT_EQ(map->warnings.size(), 1U);
  EXPECT_EQ(
      map->warnings[0],
      "The header says CT, but not that the values are Hounsfield units (image type PERFUSION "
      "RCBF). It is taken as an image of another modality (OT); no CT preset fits it.");
  EXPECT_EQ(listSeries(folder / "map")->series[0].modality, "OT");
  // The unit alone says it too.
  test::DicomBytes bytes;
  bytes.pixels = test::plainPixels(128);
  for (const auto& [unit, modality] :
       {std::pair{"HU", "CT"}, std::pair{"US", "OT"}, std::pair{"MGML", "OT"}}) {
    bytes.beforePixels = test::element(0x00281054, "LO", unit);
    test::writeBytes(folder / "one", bytes.file());
    EXPECT_EQ(importScan({.path = folder / "one"})->volume.modality, modality) << unit;
  }
  const auto warnings = importScan({.path = folder / "one"})->warnings;
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& w) {
    return w.find("Hounsfield units (unit MGML)") != std::string::npos;
  }));
}

TEST(Dicom, OneSliceWarns) {
  TestFolder folder;
  writeDicomSeries(sample(1), folder.path());
  const auto scan = importScan({.path = folder.path()});
  ASSERT_TRUE(scan) << sentence(scan.error());
  ASSERT_EQ(scan->warnings.size(), 2U);
  EXPECT_EQ(scan->warnings[0], "The thickness of the one slice is taken as 1.3 mm, as stated.");
}

TEST(Dicom, StopsWhenCancelled) {
  TestFolder folder;
  writeDicomSeries(sample(2), folder.path());
  CancelToken token;
  token.cancel();
  Progress progress;
  progress.cancel = &token;
  const auto scan = importScan({.path = folder.path()}, progress);
  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().kind, ErrorKind::Cancelled);
}

}  // namespace
}  // namespace palpate
