#include "imaging/import.h"

#include <gtest/gtest.h>

#include "imaging/volume_files.h"
#include "tests/imaging/demo_files.h"
#include "tests/imaging/volume_samples.h"

namespace palpate {
namespace {

using test::TestFolder;

std::string refusal(const std::filesystem::path& path) {
  const auto scan = importScan({.path = path});
  EXPECT_FALSE(scan);
  if (scan) return {};
  EXPECT_EQ(exitCode(scan.error().kind), 3);
  const auto list = listSeries(path);
  EXPECT_FALSE(list);
  if (!list) {
    EXPECT_EQ(sentence(list.error()), sentence(scan.error()));
  }
  return sentence(scan.error());
}

TEST(Import, MissingPath) {
  EXPECT_EQ(refusal("/no/such/scan"),
            "There is no such file or folder. File: /no/such/scan. Check the path and its "
            "spelling.");
}

TEST(Import, EmptyFolder) {
  TestFolder folder;
  EXPECT_EQ(refusal(folder.path()),
            "There are no files in there. File: " + folder.path().string() +
                ". Found: 0 other files. Expected: the images of a CT or MR study. Choose the "
                "folder, disc or archive that holds the study.");
}

TEST(Import, FolderWithoutImages) {
  TestFolder folder;
  test::writeBytes(folder / "readme.txt", "hello");
  test::writeBytes(folder / "notes.dcm", "this is not DICOM");
  EXPECT_EQ(refusal(folder.path()),
            "There are no DICOM images in there. File: " + folder.path().string() +
                ". Found: 2 other files. Expected: the images of a CT or MR study. Choose the "
                "folder, disc or archive that holds the study.");
}

TEST(Import, TextFileNamedDcm) {
  TestFolder folder;
  test::writeBytes(folder / "scan.dcm", "This is a text, not a scan.\n");
  EXPECT_EQ(refusal(folder / "scan.dcm"),
            "The file is not a scan that Palpate reads. File: " + (folder / "scan.dcm").string() +
                ". Expected: DICOM, InVesalius (.inv3), NIfTI, NRRD or MetaImage. Choose the scan "
                "itself; a file with the right ending may still be damaged.");
}

TEST(Import, EmptyFile) {
  TestFolder folder;
  test::writeBytes(folder / "scan.nii", "");
  EXPECT_NE(refusal(folder / "scan.nii"), "");
}

TEST(Import, VolumeFileIsOneSeries) {
  TestFolder folder;
  const Volume v = test::int16Volume(test::obliqueGeometry(5, 6, 7));
  ASSERT_TRUE(writeVolumeFile(v, folder / "v.nrrd"));
  const auto list = listSeries(folder / "v.nrrd");
  ASSERT_TRUE(list) << sentence(list.error());
  ASSERT_EQ(list->series.size(), 1U);
  EXPECT_TRUE(list->series[0].importable);
  EXPECT_EQ(list->series[0].geometry.dims, v.geometry.dims);
  const auto scan = importScan({.path = folder / "v.nrrd", .seriesUid = list->series[0].uid});
  ASSERT_TRUE(scan) << sentence(scan.error());
  EXPECT_EQ(scan->sourceFormat, "NRRD");
  EXPECT_EQ(scan->volume.int16, v.int16);
  const auto other = importScan({.path = folder / "v.nrrd", .seriesUid = "1.2.3"});
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().message, "The file holds no such series.");
}

TEST(Import, OneSliceWarns) {
  TestFolder folder;
  ASSERT_TRUE(writeVolumeFile(test::int16Volume(test::obliqueGeometry(5, 6, 1)), folder / "v.mha"));
  const auto scan = importScan({.path = folder / "v.mha"});
  ASSERT_TRUE(scan);
  ASSERT_EQ(scan->warnings.size(), 1U);
  EXPECT_EQ(scan->warnings[0],
            "One slice only: it can be looked at, but not felt; a tree needs two slices or more.");
}

TEST(Import, StopsWhenCancelled) {
  TestFolder folder;
  ASSERT_TRUE(writeVolumeFile(test::int16Volume(test::obliqueGeometry(5, 6, 2)), folder / "v.mha"));
  CancelToken token;
  token.cancel();
  Progress progress;
  progress.cancel = &token;
  const auto scan = importScan({.path = folder / "v.mha"}, progress);
  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().kind, ErrorKind::Cancelled);
}

TEST(Import, PseudonymsAreRandom) {
  TestFolder folder;
  ASSERT_TRUE(writeVolumeFile(test::int16Volume(test::obliqueGeometry(2, 2, 2)), folder / "v.mha"));
  std::string first;
  bool differs = false;
  for (int i = 0; i < 8; ++i) {
    const auto scan = importScan({.path = folder / "v.mha"});
    ASSERT_TRUE(scan);
    EXPECT_EQ(scan->pseudonym.size(), 9U);
    if (i == 0) first = scan->pseudonym;
    differs = differs || scan->pseudonym != first;
  }
  EXPECT_TRUE(differs);
}

}  // namespace
}  // namespace palpate
