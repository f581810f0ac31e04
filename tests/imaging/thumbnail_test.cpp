/// The small pictures of a list of series.

#include "imaging/thumbnail.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "imaging/dicom_scan.h"
#include "imaging/dicom_series.h"
#include "tests/imaging/demo_files.h"
#include "tests/imaging/dicom_bytes.h"
#include "tests/imaging/dicom_writer.h"
#include "tests/imaging/volume_samples.h"

namespace palpate {
namespace {

using test::DicomBytes;
using test::TestFolder;

/// Of the one stack in the folder.
std::optional<GreyPicture> pictureOf(const std::filesystem::path& folder) {
  const auto scan = scanDicom(folder);
  EXPECT_TRUE(scan);
  const auto stacks = groupIntoStacks(scan->files);
  EXPECT_EQ(stacks.size(), 1U);
  return thumbnailOf(scan->files, stacks.front());
}

/// Written as DICOM with pixels of these sizes (mm).
std::optional<GreyPicture> pictureOf(Volume volume, double x_mm = 1.0, double y_mm = 1.0) {
  TestFolder folder;
  volume.geometry.spacing = Eigen::Vector3d(x_mm, y_mm, 1.0) * 1e-3;
  test::writeDicomSeries(volume, folder.path());
  return pictureOf(folder.path());
}

template <class Value>
Volume volumeOf(std::int32_t columns, std::int32_t rows, std::int32_t slices, Value&& value) {
  Volume v;
  v.geometry.dims = {columns, rows, slices};
  for (int k = 0; k < slices; ++k)
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        v.int16.push_back(static_cast<std::int16_t>(value(i, j, k)));
      }
  return v;
}

std::pair<int, int> sizeOf(const std::optional<GreyPicture>& picture) {
  EXPECT_TRUE(picture);
  EXPECT_EQ(picture->grey.size(), static_cast<std::size_t>(picture->width * picture->height));
  return {picture->width, picture->height};
}

TEST(Thumbnail, ItsLongerSideHas64PixelsAndItsPixelsAreSquare) {
  const auto flat = [](int, int, int) { return 0; };
  using Size = std::pair<int, int>;
  EXPECT_EQ(sizeOf(pictureOf(volumeOf(200, 100, 1, flat))), Size(64, 32));
  EXPECT_EQ(sizeOf(pictureOf(volumeOf(100, 200, 1, flat))), Size(32, 64));
  EXPECT_EQ(sizeOf(pictureOf(volumeOf(200, 100, 1, flat), 1.0, 2.0)), Size(64, 64));
  EXPECT_EQ(sizeOf(pictureOf(volumeOf(100, 100, 1, flat), 0.5, 2.0)), Size(16, 64));
  EXPECT_EQ(sizeOf(pictureOf(volumeOf(8, 4, 1, flat))), Size(64, 32)) << "small ones are enlarged";
  EXPECT_EQ(sizeOf(pictureOf(volumeOf(1000, 1, 1, flat))), Size(64, 1));
}

TEST(Thumbnail, ShowsTheSliceInTheMiddle) {
  // Slice k is bright in its column k only.
  const auto picture =
      pictureOf(volumeOf(64, 64, 5, [](int i, int, int k) { return i == k ? 9 : 0; }));
  ASSERT_EQ(sizeOf(picture), std::pair(64, 64));
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(picture->grey[i], i == 2 ? 255 : 0) << i;
}

TEST(Thumbnail, GreyGoesFromTheFirstToTheLastPercent) {
  // 0 to 99 in a hundred rows; a pixel far below and one far above do not darken the rest.
  const auto picture = pictureOf(volumeOf(100, 100, 1, [](int i, int j, int) {
    if (i == 0 && j == 50) return -30'000;
    return i == 99 && j == 50 ? 30'000 : j;
  }));
  ASSERT_EQ(sizeOf(picture), std::pair(64, 64));
  const auto grey = [&](int x, int y) {
    return picture->grey[static_cast<std::size_t>(64 * y + x)];
  };
  EXPECT_LE(grey(32, 0), 1);
  EXPECT_GE(grey(32, 63), 254);
  EXPECT_NEAR(grey(32, 31), 127, 3);
  EXPECT_EQ(grey(0, 32), 0);
  EXPECT_EQ(grey(63, 32), 255);
}

TEST(Thumbnail, APixelIsTheMeanOfThoseThatItCovers) {
  // A chessboard at twice the size: all is grey.
  const auto picture = pictureOf(
      volumeOf(128, 128, 1, [](int i, int j, int) { return (i + j) % 2 == 0 ? 1000 : 0; }));
  ASSERT_EQ(sizeOf(picture), std::pair(64, 64));
  EXPECT_TRUE(std::all_of(picture->grey.begin(), picture->grey.end(),
                          [](std::uint8_t g) { return g == 127 || g == 128; }));
}

TEST(Thumbnail, AnImageOfOneValueIsBlack) {
  const auto picture = pictureOf(volumeOf(10, 10, 1, [](int, int, int) { return 700; }));
  EXPECT_EQ(std::count(picture->grey.begin(), picture->grey.end(), 0), 64 * 64);
}

TEST(Thumbnail, Monochrome1IsShownAsMeant) {
  DicomBytes d;
  d.pixels = test::plainPixels(128);
  const auto pictureOfBytes = [](const std::string& bytes) {
    TestFolder folder;
    test::writeBytes(folder / "image", bytes);
    return pictureOf(folder.path());
  };
  const std::string plain = d.file();
  std::string inverse = plain;
  inverse.replace(inverse.find("MONOCHROME2"), 11, "MONOCHROME1");
  const auto a = pictureOfBytes(plain);
  const auto b = pictureOfBytes(inverse);
  ASSERT_EQ(sizeOf(a), sizeOf(b));
  for (std::size_t i = 0; i < a->grey.size(); ++i) EXPECT_EQ(a->grey[i] + b->grey[i], 255);
}

TEST(Thumbnail, ThereIsNoneOfWhatCannotBeDecodedOrIsTooLarge) {
  DicomBytes d;
  d.pixels = test::encapsulated({std::string(100, '\x11')});
  TestFolder folder;
  test::writeBytes(folder / "image", d.file(test::kJpegLs));
  EXPECT_FALSE(pictureOf(folder.path()));
  EXPECT_FALSE(thumbnailOf({}, DicomStack{}));
  // More than 64 Mi pixels in one file: it would be decoded whole. They take no place on the disk.
  const std::uint32_t side = 8193;
  DicomBytes large;
  large.rows = large.columns = side;
  large.bitsAllocated = large.bitsStored = 8;
  large.pixels = test::elementHead(0x7FE00010, "OB", side * side + 1);
  test::writeBytes(folder / "image", large.file());
  std::filesystem::resize_file(folder / "image",
                               std::filesystem::file_size(folder / "image") + side * side + 1);
  EXPECT_FALSE(pictureOf(folder.path()));
}

}  // namespace
}  // namespace palpate
