#include "imaging/invesalius_masks.h"

#include <gtest/gtest.h>

#include "imaging/import.h"
#include "imaging/segment/agreement.h"
#include "tests/imaging/archive_samples.h"
#include "tests/imaging/demo_files.h"
#include "tests/imaging/volume_samples.h"

namespace palpate {
namespace {

using test::TestFolder;
using Labels = std::vector<std::uint8_t>;

TEST(InvesaliusMasks, OfCraniumAreItsThresholdsVoxelByVoxel) {
  PALPATE_NEEDS(test::demoCt(), "Debian package invesalius-examples");
  const auto masks = listInvesaliusMasks(test::demoCt());
  ASSERT_TRUE(masks) << sentence(masks.error());
  ASSERT_EQ(masks->size(), 2U);
  EXPECT_EQ((*masks)[0].name, "Máscara 1");
  EXPECT_EQ((*masks)[0].colour, (std::array<std::uint8_t, 3>{84, 255, 84}));
  EXPECT_EQ((*masks)[0].threshold.low, 226.0);
  EXPECT_EQ((*masks)[0].threshold.high, 3071.0);
  EXPECT_EQ((*masks)[1].name, "Máscara 2");
  EXPECT_EQ((*masks)[1].threshold.low, -142.0);
  EXPECT_EQ((*masks)[1].threshold.high, 2986.0);
  const auto scan = importScan({.path = test::demoCt()});
  ASSERT_TRUE(scan) << sentence(scan.error());
  const std::array<std::size_t, 2> voxels{475759, 2319106};  // counted in the project's own bytes
  for (std::size_t m = 0; m < 2; ++m) {
    const auto mask = readInvesaliusMask(test::demoCt(), (*masks)[m]);
    ASSERT_TRUE(mask) << sentence(mask.error());
    const auto ours = segment(scan->volume, nullptr, 1, {.range = (*masks)[m].threshold});
    ASSERT_TRUE(ours) << sentence(ours.error());
    EXPECT_EQ(mask->labels, ours->labels);
    const auto agreement = compareMasks({*ours, std::nullopt}, {*mask, std::nullopt});
    ASSERT_TRUE(agreement) << sentence(agreement.error());
    EXPECT_EQ(agreement->voxels, (std::array<std::size_t, 2>{voxels[m], voxels[m]}));
    EXPECT_EQ(agreement->dice, 1.0);
    EXPECT_EQ(agreement->surface->symmetric.worst, 0.0);
  }
}

/// A project of 2 slices of 2 rows of 3 columns with one mask; what a test makes wrong is replaced.
struct Sample {
  std::string masks = "<key>0</key><string>mask_0.plist</string>";
  std::string shape = "<integer>3</integer><integer>3</integer><integer>4</integer>";
  std::string range = "<integer>4</integer><integer>8</integer>";
  std::string colour = "<real>1</real><real>0.5</real><integer>0</integer>";
  std::string file = "../mask_0.dat";
  Labels mask = Labels(3 * 3 * 4);

  /// Marks the slice as worked out.
  void mark(std::size_t slice) { mask[(slice + 1) * 12] = 1; }
  /// By the file's own order: row 0 is posterior.
  std::uint8_t& at(std::size_t column, std::size_t row, std::size_t slice) {
    return mask[((slice + 1) * 3 + row + 1) * 4 + column + 1];
  }

  void write(const std::filesystem::path& to) const {
    const std::string main =
        "<plist version=\"1.0\"><dict><key>masks</key><dict>" + masks +
        "</dict><key>matrix</key><dict><key>dtype</key><string>int16</string><key>filename</key>"
        "<string>matrix.dat</string><key>shape</key><array><integer>2</integer><integer>2</integer>"
        "<integer>3</integer></array></dict><key>modality</key><string>CT</string><key>spacing"
        "</key><array><real>1</real><real>2</real><real>3</real></array></dict></plist>";
    const std::string maskPlist =
        "<plist version=\"1.0\"><dict><key>colour</key><array>" + colour +
        "</array><key>mask_file</key><string>" + file + "</string><key>mask_shape</key><array>" +
        shape + "</array><key>name</key><string>Bone</string><key>threshold_range</key><array>" +
        range + "</array></dict></plist>";
    std::string matrix;
    for (std::int16_t v = 0; v < 12; ++v) {
      matrix.append(reinterpret_cast<const char*>(&v), 2);
    }
    test::writeArchive(to, "tar.gz",
                       {{"t/main.plist", main},
                        {"t/mask_0.plist", maskPlist},
                        {"t/matrix.dat", matrix},
                        {"t/mask_0.dat", std::string(mask.begin(), mask.end())}});
  }
};

Labels labelsOf(const Sample& sample) {
  TestFolder folder;
  sample.write(folder / "p.inv3");
  const auto masks = listInvesaliusMasks(folder / "p.inv3");
  EXPECT_TRUE(masks) << sentence(masks.error());
  if (!masks || masks->empty()) return {};
  const auto grid = readInvesaliusMask(folder / "p.inv3", masks->front());
  EXPECT_TRUE(grid) << sentence(grid.error());
  return grid ? grid->labels : Labels{};
}

TEST(InvesaliusMasks, RowsAreFlippedAndTheBorderLeftOut) {
  Sample sample;
  sample.mark(0);
  sample.mark(1);
  sample.at(2, 0, 0) = 255;
  sample.at(0, 1, 1) = 255;
  EXPECT_EQ(labelsOf(sample), (Labels{0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0}));
}

TEST(InvesaliusMasks, LieOnTheVolumesGrid) {
  TestFolder folder;
  Sample().write(folder / "p.inv3");
  const auto masks = listInvesaliusMasks(folder / "p.inv3");
  ASSERT_TRUE(masks) << sentence(masks.error());
  EXPECT_EQ(masks->front().colour, (std::array<std::uint8_t, 3>{255, 128, 0}));
  const auto mask = readInvesaliusMask(folder / "p.inv3", masks->front());
  const auto scan = importScan({.path = folder / "p.inv3"});
  ASSERT_TRUE(mask && scan);
  EXPECT_EQ(mask->geometry.dims, scan->volume.geometry.dims);
  EXPECT_EQ(mask->geometry.cornerDistance(scan->volume.geometry), 0.0);
}

TEST(InvesaliusMasks, InMarkedSlicesThatIsSelectedWhichIsDrawn) {
  Sample sample;
  sample.mark(0);
  sample.mark(1);
  const Labels values{0, 1, 2, 127, 128, 253};
  for (std::size_t i = 0; i < 6; ++i) sample.at(i % 3, i / 3, 0) = values[i];
  sample.at(0, 0, 1) = 254;
  sample.at(1, 0, 1) = 255;
  EXPECT_EQ(labelsOf(sample), (Labels{0, 1, 1, 0, 0, 0, 0, 0, 0, 1, 1, 0}));
}

TEST(InvesaliusMasks, UnmarkedSlicesAreThresholdedAndKeepWhatWasPainted) {
  Sample sample;  // grey values 0..5 in slice 0, 6..11 in slice 1; 4 to 8 is in range
  sample.mark(0);
  sample.at(0, 1, 0) = 255;  // grey 3, out of range, but worked out
  sample.at(0, 0, 1) = 1;    // 6: erased
  sample.at(1, 0, 1) = 2;    // 7: erased
  sample.at(0, 1, 1) = 255;  // 9: from an older threshold
  sample.at(1, 1, 1) = 254;  // 10: painted
  sample.at(2, 1, 1) = 253;  // 11: painted
  EXPECT_EQ(labelsOf(sample), (Labels{1, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0, 1}));
}

TEST(InvesaliusMasks, AProjectMayHaveNone) {
  TestFolder folder;
  Sample sample;
  sample.masks.clear();
  sample.write(folder / "p.inv3");
  const auto masks = listInvesaliusMasks(folder / "p.inv3");
  ASSERT_TRUE(masks) << sentence(masks.error());
  EXPECT_TRUE(masks->empty());
}

TEST(InvesaliusMasks, ComeInTheOrderOfTheirNumbers) {
  TestFolder folder;
  Sample sample;
  sample.masks =
      "<key>10</key><string>nothing.plist</string><key>2</key><string>mask_0.plist</string>";
  sample.write(folder / "p.inv3");
  const auto masks = listInvesaliusMasks(folder / "p.inv3");
  ASSERT_FALSE(masks);  // the tenth is looked for last
  EXPECT_EQ(sentence(masks.error()),
            "The archive lacks a part. File: " + (folder / "p.inv3").string() +
                ". Field: nothing.plist. Found: nothing. Copy the file "
                "again from where it came.");
}

/// The error of listing the sample's masks, or of reading the first.
Error refusalOf(const Sample& sample) {
  TestFolder folder;
  sample.write(folder / "p.inv3");
  const auto masks = listInvesaliusMasks(folder / "p.inv3");
  if (!masks) return masks.error();
  const auto grid = readInvesaliusMask(folder / "p.inv3", masks->front());
  if (!grid) return grid.error();
  ADD_FAILURE() << "was accepted";
  return {};
}

TEST(InvesaliusMasks, OfAnotherSizeThanTheVoxelsAreRefused) {
  for (const char* shape : {"", "<integer>3</integer><integer>3</integer>",
                            "<integer>2</integer><integer>2</integer><integer>3</integer>",
                            "<integer>3</integer><integer>4</integer><integer>3</integer>",
                            "<integer>3</integer><integer>3</integer><integer>4000000000</integer>",
                            "<integer>-3</integer><integer>-3</integer><integer>4</integer>"}) {
    Sample sample;
    sample.shape = shape;
    const Error error = refusalOf(sample);
    EXPECT_EQ(error.kind, ErrorKind::InputRefused);
    EXPECT_EQ(error.field, "mask_0.plist: mask_shape") << shape;
    EXPECT_EQ(error.expected, "3, 3, 4");
    EXPECT_EQ(error.advice, "Open the project in InVesalius and save it again.");
  }
}

TEST(InvesaliusMasks, OfAnotherLengthAreRefused) {
  Sample sample;
  sample.mask.resize(35);
  const Error cut = refusalOf(sample);
  EXPECT_EQ(cut.message, "The voxels of a mask of the InVesalius project are cut short.");
  EXPECT_EQ(cut.field, "mask_0.dat");
  EXPECT_EQ(cut.found, "35 bytes");
  EXPECT_EQ(cut.expected, "36 bytes");
  sample.mask.resize(37);
  EXPECT_EQ(refusalOf(sample).message, "A part of the archive is larger than it states.");
}

TEST(InvesaliusMasks, WrongFieldsAreNamed) {
  Sample range;
  range.range = "<integer>4</integer>";
  EXPECT_EQ(refusalOf(range).field, "mask_0.plist: threshold_range");
  range.range = "<real>nan</real><real>4</real>";
  EXPECT_EQ(refusalOf(range).field, "mask_0.plist: threshold_range");
  Sample colour;
  colour.colour = "<real>1</real><real>1e9</real><real>0</real>";
  EXPECT_EQ(refusalOf(colour).field, "mask_0.plist: colour");
  Sample file;
  file.file = "";
  EXPECT_EQ(refusalOf(file).field, "mask_0.plist: mask_file");
  file.file = "/etc/passwd";  // only the last name counts, and only in the archive
  EXPECT_EQ(refusalOf(file).field, "passwd");
  Sample masks;
  masks.masks = "<key>0</key><string/>";
  EXPECT_EQ(refusalOf(masks).field, "main.plist: masks");
  masks.masks = "<key>-1</key><string>mask_0.plist</string>";
  EXPECT_EQ(refusalOf(masks).field, "main.plist: masks");
  masks.masks.clear();
  for (int m = 0; m < 1001; ++m) {
    masks.masks += "<key>" + std::to_string(m) + "</key><string>mask_0.plist</string>";
  }
  EXPECT_EQ(refusalOf(masks).found, "more than 1000 masks");
  Sample xml;
  xml.masks = "<key>0</key><string>matrix.dat</string>";
  EXPECT_EQ(refusalOf(xml).found, "text that is not XML");
}

}  // namespace
}  // namespace palpate
