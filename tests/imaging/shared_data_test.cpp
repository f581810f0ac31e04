/// Real series against what independent tools found (reference.json of the shared test data), and
/// difficult files against the words they must be refused with.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "imaging/import.h"
#include "tests/imaging/demo_files.h"
#include "tests/imaging/volume_samples.h"

namespace palpate {
namespace {

constexpr double kCorner_m = 1e-6;  // 0.001 mm

nlohmann::json reference() {
  std::ifstream in(test::sharedData() / "reference.json");
  return nlohmann::json::parse(in);
}

Eigen::Vector3d vector(const nlohmann::json& j) {
  return {j[0].get<double>(), j[1].get<double>(), j[2].get<double>()};
}

/// The eight corners from the headers: origin, last origin, directions, pixel spacing.
std::array<Eigen::Vector3d, 8> referenceCorners_mm(const nlohmann::json& g) {
  const Eigen::Vector3d row =
      vector(g["row_direction"]) * g["spacing_xy"][0].get<double>() * (g["dims"][0].get<int>() - 1);
  const Eigen::Vector3d column = vector(g["column_direction"]) * g["spacing_xy"][1].get<double>() *
                                 (g["dims"][1].get<int>() - 1);
  std::array<Eigen::Vector3d, 8> corners;
  for (std::size_t c = 0; c < 8; ++c) {
    corners[c] = vector(g[(c & 4U) != 0 ? "last_origin_lps" : "origin_lps"]);
    if ((c & 1U) != 0) corners[c] += row;
    if ((c & 2U) != 0) corners[c] += column;
  }
  return corners;
}

class SeriesReference : public testing::TestWithParam<const char*> {};

TEST_P(SeriesReference, CornersAndVoxelsAreEqual) {
  PALPATE_NEEDS(test::sharedData() / "reference.json", "shared test data");
  const auto all = reference();
  const auto& series = all["series"][GetParam()]["series"][0];
  const auto scan = importScan({.path = test::sharedData() / GetParam()});
  ASSERT_TRUE(scan) << sentence(scan.error());
  EXPECT_EQ(voxelsSha256(scan->volume),
            series["sha256_int16_le_rescaled_x_fastest_z_along_normal"].get<std::string>());
  const auto expected = referenceCorners_mm(series["geometry_from_headers"]);
  const auto found = scan->volume.geometry.cornerCentres_P();
  for (std::size_t c = 0; c < 8; ++c) {
    EXPECT_LT((found[c] - expected[c] * 1e-3).norm(), kCorner_m) << "corner " << c;
  }
}

INSTANTIATE_TEST_SUITE_P(
    SharedData, SeriesReference,
    testing::Values("series/ct_head_cranium", "archives/mr_brain_sag_mprage.tar.xz",
                    "archives/ct_abdomen_spine_lidc.tar.xz", "difficult/geometry/mr_two_slices",
                    "difficult/geometry/mr_oblique_hitachi_4", "difficult/derived/big_spacing",
                    "difficult/derived/scout_in_series",
                    "difficult/derived/wrong_instance_numbers"));

/// One difficult file or folder: the range of its values, or the beginning of its refusal.
struct Difficult {
  const char* path;
  std::optional<std::pair<double, double>> range;
  const char* refusal = "";
  bool lossy = false;
};

void PrintTo(const Difficult& d, std::ostream* out) {
  *out << d.path;
}

class DifficultFile : public testing::TestWithParam<Difficult> {};

TEST_P(DifficultFile, IsRightOrRefused) {
  PALPATE_NEEDS(test::sharedData() / "difficult", "shared test data");
  const Difficult& d = GetParam();
  const auto scan = importScan({.path = test::sharedData() / "difficult" / d.path});
  if (!d.range) {
    ASSERT_FALSE(scan);
    EXPECT_EQ(exitCode(scan.error().kind), 3);
    EXPECT_TRUE(scan.error().message.starts_with(d.refusal)) << scan.error().message;
    EXPECT_TRUE(scan.error().advice.has_value());
    return;
  }
  ASSERT_TRUE(scan) << sentence(scan.error());
  const auto [low, high] = valueRange(scan->volume);
  EXPECT_NEAR(low, d.range->first, 1e-3);
  EXPECT_NEAR(high, d.range->second, 1e-3);
  EXPECT_EQ(scan->lossy, d.lossy);
}

using Range = std::pair<double, double>;
constexpr const char* kNoVolume = "The series cannot become a volume: ";
constexpr const char* kUndecoded = "A DICOM image could not be decoded: ";

// Ranges from reference.json (pydicom and GDCM agree) or, for the masked and the packed file, from
// the bits that the header states.
INSTANTIATE_TEST_SUITE_P(
    TransferSyntaxes, DifficultFile,
    testing::Values(
        Difficult{"transfer_syntax/ct_implicit_le.dcm", Range{-3024, 1378}},
        Difficult{"transfer_syntax/ct_explicit_le.dcm", Range{-3024, 1378}},
        Difficult{"transfer_syntax/ct_explicit_be.dcm", Range{-3024, 1378}},
        Difficult{"transfer_syntax/ct_deflated.dcm", Range{-3024, 1378}},
        Difficult{"transfer_syntax/ct_rle.dcm", Range{-3024, 1378}},
        Difficult{"transfer_syntax/ct_jpeg_baseline_50.dcm", Range{-3083.352, 1349.4288}, "", true},
        Difficult{"transfer_syntax/ct_jpeg_extended_51.dcm", Range{-3052.8787, 1369.6608}, "",
                  true},
        Difficult{"transfer_syntax/ct_jpeg_spectral_53_retired.dcm", Range{-3052.8787, 1369.6608},
                  "", true},
        Difficult{"transfer_syntax/ct_jpeg_progressive_55_retired.dcm",
                  Range{-3052.8787, 1369.6608}, "", true},
        Difficult{"transfer_syntax/ct_jpeg_lossless_57.dcm", Range{-3024, 1378}},
        Difficult{"transfer_syntax/ct_jpeg_lossless_sv1_70.dcm", Range{-3024, 1378}},
        Difficult{"transfer_syntax/ct_jpegls_lossless_80.dcm", Range{-3024, 1378}},
        Difficult{"transfer_syntax/ct_jpegls_near_81.dcm", Range{-3025, 1377}, "", true},
        Difficult{"transfer_syntax/ct_j2k_lossless_90.dcm", Range{-3024, 1378}},
        Difficult{"transfer_syntax/ct_j2k_91.dcm", Range{-3027, 1377}, "", true}));

INSTANTIATE_TEST_SUITE_P(
    Others, DifficultFile,
    testing::Values(
        Difficult{"pixel_format/CT_small.dcm", Range{-896, 1167}},
        Difficult{"pixel_format/MR_small_implicit.dcm", Range{127, 2145}},
        Difficult{"pixel_format/MR_small_padded.dcm", Range{127, 2145}},
        Difficult{"pixel_format/J2K_pixelrep_mismatch.dcm", Range{-2000, 1896}},
        Difficult{"pixel_format/mr_12bitUnsigned_0x0F0F.dcm", Range{0, 4095}},
        Difficult{"pixel_format/mr_12bit_packed.dcm", Range{0, 254}},
        Difficult{"pixel_format/cr_monochrome1_no_preamble", {}, kNoVolume},
        Difficult{"pixel_format/SC_rgb_jpeg_dcmtk.dcm",
                  {},
                  "The series cannot become a volume: its image is in colour."},
        Difficult{"pixel_format/parametric_map_float.dcm",
                  {},
                  "The series cannot become a volume: its pixels are floating-point numbers"},
        Difficult{"pixel_format/liver_nonbyte_aligned_rle.dcm",
                  {},
                  "The series cannot become a volume: its image has one bit per pixel"},
        Difficult{"pixel_format/rtstruct.dcm",
                  {},
                  "The series cannot become a volume: it holds no image (RTSTRUCT)."},
        Difficult{"enhanced/mr_philips_8frames", Range{0, 1081.748413}},
        Difficult{"enhanced/emri_small.dcm", {}, kNoVolume},
        Difficult{"geometry/ct_irregular_increment", {}, "The series is not a regular box: "},
        Difficult{"geometry/mr_mixed_orientation", {}, "There are several volumes in there."},
        Difficult{"derived/mixed_series", {}, "There are several volumes in there."},
        Difficult{"derived/missing_slices", {}, "The series is not a regular box: "},
        Difficult{"derived/duplicate_slices",
                  {},
                  "The series cannot become a volume: different images lie at the same place"},
        Difficult{"dicomdir/DICOMDIR", {}, "There are several volumes in there."},
        Difficult{"file_structure/MR_truncated.dcm", {}, kUndecoded},
        Difficult{"file_structure/GH178.dcm", {}, kUndecoded},
        Difficult{"file_structure/no_meta.dcm", {}, "The file is not a scan that Palpate reads."},
        Difficult{
            "file_structure/UN_sequence.dcm", {}, "The DICOM file holds no image, or is damaged."},
        Difficult{"malformed/no_position.dcm",
                  {},
                  "The series cannot become a volume: it states no position in the patient."},
        Difficult{"malformed/orientation_zero.dcm", {}, kNoVolume},
        Difficult{"malformed/spacing_zero.dcm", {}, kNoVolume},
        Difficult{"malformed/slope_zero.dcm",
                  {},
                  "The series cannot become a volume: its rescale slope is zero."},
        Difficult{"malformed/rows_zero.dcm", {}, kNoVolume},
        Difficult{
            "malformed/rows_cols_65535.dcm",
            {},
            "The series cannot become a volume: it states an image of an impossible size (65535"},
        Difficult{"malformed/pixel_length_4g.dcm", {}, kUndecoded},
        Difficult{"malformed/truncated_half.dcm", {}, kUndecoded}));

TEST(SharedData, TiltedHeadIsRefusedAndRepaired) {
  PALPATE_NEEDS(test::sharedData() / "archives", "shared test data");
  ImportRequest request{.path = test::sharedData() / "archives/ct_head_tilt_irregular_ge.tar.xz"};
  const auto refused = importScan(request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message,
            "The series is not a regular box: its slices are sheared against their normal by 18.5 "
            "degrees (gantry tilt), up to 48.2 mm; its slices are 1.08 to 7 mm apart (uneven "
            "spacing or missing slices).");
  request.repairTilt = request.repairSpacing = true;
  const auto scan = importScan(request);
  ASSERT_TRUE(scan) << sentence(scan.error());
  ASSERT_EQ(scan->repairs.size(), 1U);
  EXPECT_NE(scan->repairs[0].find("Largest displacement of a slice: "), std::string::npos)
      << scan->repairs[0];
}

TEST(SharedData, FuzzedFilesNeverCrash) {
  PALPATE_NEEDS(test::sharedData() / "difficult/fuzz", "shared test data");
  for (const auto& file :
       std::filesystem::directory_iterator(test::sharedData() / "difficult/fuzz")) {
    const auto scan = importScan({.path = file.path()});
    if (!scan) {
      EXPECT_EQ(exitCode(scan.error().kind), 3) << file.path();
    }
  }
}

TEST(SharedData, NamesInAnyCharacterSet) {
  PALPATE_NEEDS(test::sharedData() / "difficult/charset", "shared test data");
  const auto all = reference();
  for (const char* name : {"chrFren", "chrGreek", "chrH31", "chrRuss", "chrX1"}) {
    const std::string path = std::string("difficult/charset/") + name + ".dcm";
    const auto list = listSeries(test::sharedData() / path);
    ASSERT_TRUE(list) << sentence(list.error());
    EXPECT_EQ(list->series[0].patientName,
              all["files"][path]["patient_name_utf8"].get<std::string>());
  }
}

TEST(SharedData, MixedFolderIsTakenApart) {
  PALPATE_NEEDS(test::sharedData() / "difficult/derived", "shared test data");
  const auto list = listSeries(test::sharedData() / "difficult/derived/mixed_series");
  ASSERT_TRUE(list);
  EXPECT_EQ(list->skippedFiles, 7U);  // texts, a picture, zeros, empty and fake files
  std::size_t importable = 0;
  for (const SeriesInfo& s : list->series) importable += s.importable ? 1 : 0;
  EXPECT_EQ(importable, 10U);  // three volumes, seven single images of other orientations
  const auto oblique =
      importScan({.path = test::sharedData() / "difficult/derived/mixed_series",
                  .seriesUid = "1.2.826.0.1.3680043.8.498.172569766509356122702857987"});
  ASSERT_TRUE(oblique) << sentence(oblique.error());
  EXPECT_EQ(voxelsSha256(oblique->volume),
            "d1e2c1abde25dba08fc6bae088f7e99afb97773a6bc4db04730a82d9de1f172d");
}

TEST(SharedData, NoRefusalHoldsAName) {
  PALPATE_NEEDS(test::sharedData() / "reference.json", "shared test data");
  const auto all = reference();
  for (const auto& [path, facts] : all["files"].items()) {
    if (!facts.contains("patient_name_utf8") || path.find("volumes/") == 0) continue;
    const auto name = facts["patient_name_utf8"].get<std::string>();
    const auto scan = importScan({.path = test::sharedData() / path});
    const std::string words =
        scan ? scan->description + " " + scan->pseudonym : sentence(scan.error());
    EXPECT_EQ(words.find(name), std::string::npos) << path;
  }
}

}  // namespace
}  // namespace palpate
