#include "imaging/volume_files.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <limits>

#include "tests/imaging/demo_files.h"
#include "tests/imaging/volume_samples.h"

namespace palpate {
namespace {

using test::TestFolder;

constexpr double kCorner_m = 1e-6;  // 0.001 mm: the promise of design.md

class RoundTrip : public testing::TestWithParam<const char*> {};

TEST_P(RoundTrip, ObliqueInt16KeepsCornersAndVoxels) {
  TestFolder folder;
  const Volume v = test::int16Volume(test::obliqueGeometry(13, 9, 7));
  const auto file = folder / GetParam();
  const auto wrote = writeVolumeFile(v, file);
  ASSERT_TRUE(wrote) << sentence(wrote.error());
  const auto back = readVolumeFile(file);
  ASSERT_TRUE(back) << sentence(back.error());
  EXPECT_EQ(back->geometry.dims, v.geometry.dims);
  EXPECT_LT(back->geometry.cornerDistance(v.geometry), kCorner_m);
  EXPECT_EQ(back->type, VoxelType::Int16);
  EXPECT_EQ(back->int16, v.int16);
  EXPECT_EQ(voxelsSha256(*back), voxelsSha256(v));
  EXPECT_EQ(test::filesIn(folder.path()), 1U) << "nothing beside the file";
}

TEST_P(RoundTrip, ObliqueFloat32KeepsCornersAndVoxels) {
  TestFolder folder;
  const Volume v = test::float32Volume(test::obliqueGeometry(6, 11, 5));
  const auto file = folder / GetParam();
  ASSERT_TRUE(writeVolumeFile(v, file));
  const auto back = readVolumeFile(file);
  ASSERT_TRUE(back) << sentence(back.error());
  EXPECT_LT(back->geometry.cornerDistance(v.geometry), kCorner_m);
  EXPECT_EQ(back->type, VoxelType::Float32);
  EXPECT_EQ(back->float32, v.float32);
}

TEST_P(RoundTrip, LabelsKeepCornersAndValues) {
  TestFolder folder;
  LabelGrid labels;
  labels.geometry = test::obliqueGeometry(16, 16, 2);
  labels.labels.resize(labels.geometry.voxelCount());
  for (std::size_t i = 0; i < labels.labels.size(); ++i) {
    labels.labels[i] = static_cast<std::uint8_t>(i % 256);
  }
  const auto file = folder / GetParam();
  ASSERT_TRUE(writeLabelFile(labels, file));
  const auto back = readLabelFile(file);
  ASSERT_TRUE(back) << sentence(back.error());
  EXPECT_LT(back->geometry.cornerDistance(labels.geometry), kCorner_m);
  EXPECT_EQ(back->labels, labels.labels);
}

INSTANTIATE_TEST_SUITE_P(EveryFormat, RoundTrip,
                         testing::Values("v.mha", "v.nrrd", "v.nii", "v.nii.gz"));

TEST(VolumeFiles, LargeOffsetKeepsCorners) {
  // Six digits, MetaImage's default, would move this corner by 0.05 mm.
  TestFolder folder;
  GridGeometry g = test::obliqueGeometry(4, 4, 4);
  g.X_PV.translation() = Eigen::Vector3d(-1234.56789, 2345.67891, -987.654321) * 1e-3;
  for (const char* name : {"v.mha", "v.nrrd"}) {
    ASSERT_TRUE(writeVolumeFile(test::int16Volume(g), folder / name));
    const auto back = readVolumeFile(folder / name);
    ASSERT_TRUE(back);
    EXPECT_LT(back->geometry.cornerDistance(g), 1e-9) << name;
  }
}

TEST(VolumeFiles, LeftHandedGridKeepsEveryVoxelInItsPlace) {
  TestFolder folder;
  std::string text =
      "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
      "TransformMatrix = 1 0 0 0 1 0 0 0 -1\nOffset = 10 20 30\nElementSpacing = 1 2 3\n"
      "DimSize = 2 1 3\nElementType = MET_SHORT\nElementDataFile = LOCAL\n";
  for (std::int16_t v = 0; v < 6; ++v) {
    text.append(reinterpret_cast<const char*>(&v), 2);
  }
  test::writeBytes(folder / "v.mha", text);
  const auto v = readVolumeFile(folder / "v.mha");
  ASSERT_TRUE(v) << sentence(v.error());
  EXPECT_GT(v->geometry.X_PV.linear().determinant(), 0.0);
  // Value 5 was at i=1, k=2: P = (11, 20, 24); it is now the slice with k=0.
  EXPECT_EQ(v->int16, (std::vector<std::int16_t>{4, 5, 2, 3, 0, 1}));
  const Eigen::Vector3d p_mm = v->geometry.X_PV * v->geometry.centre_V(1, 0, 0) * 1e3;
  EXPECT_LT((p_mm - Eigen::Vector3d(11, 20, 24)).norm(), 1e-9);
}

/// A .nii of 4×3×2 int16, its bytes ready to be spoiled.
std::string niftiBytes(const TestFolder& folder) {
  GridGeometry g;
  g.dims = {4, 3, 2};
  const auto file = folder / "good.nii";
  EXPECT_TRUE(writeVolumeFile(test::int16Volume(g), file));
  return test::readBytes(file);
}

TEST(Nifti, ShearedSformIsRefused) {
  TestFolder folder;
  std::string bytes = niftiBytes(folder);
  test::patch(bytes, 284, 0.1F);  // srow_x[1]: y leans towards x
  test::writeBytes(folder / "v.nii", bytes);
  const auto v = readVolumeFile(folder / "v.nii");
  ASSERT_FALSE(v);
  EXPECT_EQ(sentence(v.error()),
            "The voxel axes are sheared, which Palpate does not show. File: " +
                (folder / "v.nii").string() +
                ". Field: sform. Found: axes 5.711 degrees off square. Expected: three orthogonal "
                "axes of non-zero length. Resample the image to an orthogonal grid in the program "
                "that made it, then import that.");
  EXPECT_EQ(v.error().kind, ErrorKind::InputRefused);
}

TEST(Nifti, QformIsUsedWithoutSform) {
  TestFolder folder;
  const GridGeometry g = test::obliqueGeometry(4, 3, 2);
  ASSERT_TRUE(writeVolumeFile(test::int16Volume(g), folder / "v.nii"));
  std::string bytes = test::readBytes(folder / "v.nii");
  test::patch(bytes, 254, std::int16_t{0});
  for (std::size_t at = 280; at < 328; at += 4) test::patch(bytes, at, 0.0F);
  test::writeBytes(folder / "q.nii", bytes);
  std::vector<std::string> warnings;
  const auto v = readVolumeFile(folder / "q.nii", &warnings);
  ASSERT_TRUE(v) << sentence(v.error());
  EXPECT_LT(v->geometry.cornerDistance(g), kCorner_m);
  EXPECT_TRUE(warnings.empty());
}

TEST(Nifti, WithoutAPlaceInThePatientWarns) {
  TestFolder folder;
  std::string bytes = niftiBytes(folder);
  test::patch(bytes, 252, std::int16_t{0});
  test::patch(bytes, 254, std::int16_t{0});
  test::writeBytes(folder / "v.nii", bytes);
  std::vector<std::string> warnings;
  ASSERT_TRUE(readVolumeFile(folder / "v.nii", &warnings));
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0],
            "The file does not say how the voxels lie in the patient: the letters R, L, A, P, H "
            "and F are a guess.");
}

TEST(Nifti, FourthAxisIsRefused) {
  TestFolder folder;
  std::string bytes = niftiBytes(folder);
  test::patch(bytes, 40, std::int16_t{4});
  test::patch(bytes, 48, std::int16_t{2});
  bytes += bytes.substr(352);
  test::writeBytes(folder / "v.nii", bytes);
  const auto v = readVolumeFile(folder / "v.nii");
  ASSERT_FALSE(v);
  EXPECT_EQ(v.error().message, "The file holds several volumes (a fourth axis).");
  EXPECT_EQ(v.error().found, "2 volumes");
}

TEST(Nifti, CutShortIsRefused) {
  TestFolder folder;
  GridGeometry g;
  g.dims = {32, 32, 16};
  for (const char* name : {"v.nii", "v.nii.gz"}) {
    ASSERT_TRUE(writeVolumeFile(test::int16Volume(g), folder / name));
    const std::string bytes = test::readBytes(folder / name);
    test::writeBytes(folder / name, bytes.substr(0, bytes.size() / 2));
    const auto v = readVolumeFile(folder / name);
    ASSERT_FALSE(v) << name;
    EXPECT_EQ(sentence(v.error()),
              "The NIfTI file ends before its last voxel. File: " + (folder / name).string() +
                  ". It is damaged or cut short: copy it again from where it came.");
  }
}

TEST(VolumeFiles, CutShortIsRefusedInEveryFormat) {
  TestFolder folder;
  GridGeometry g;
  g.dims = {32, 32, 16};
  for (const char* name : {"v.mha", "v.nrrd"}) {
    ASSERT_TRUE(writeVolumeFile(test::int16Volume(g), folder / name));
    const std::string bytes = test::readBytes(folder / name);
    test::writeBytes(folder / name, bytes.substr(0, bytes.size() / 2));
    EXPECT_FALSE(readVolumeFile(folder / name)) << name;
  }
}

TEST(VolumeFiles, HugeClaimIsRefusedBeforeMemoryIsAskedFor) {
  TestFolder folder;
  test::writeBytes(folder / "v.mha",
                   "ObjectType = Image\nNDims = 3\nBinaryData = True\nDimSize = 1290 1290 1290\n"
                   "ElementType = MET_SHORT\nElementDataFile = LOCAL\nx");
  const auto v = readVolumeFile(folder / "v.mha");
  ASSERT_FALSE(v);
  EXPECT_EQ(v.error().message, "The MetaImage file is too short for the size it states.");
}

TEST(VolumeFiles, NotANumberIsRefusedWithItsPlace) {
  TestFolder folder;
  Volume v = test::float32Volume(test::obliqueGeometry(4, 3, 2));
  v.float32[v.geometry.index(2, 1, 1)] = std::numeric_limits<float>::quiet_NaN();
  ASSERT_TRUE(writeVolumeFile(v, folder / "v.nrrd"));
  const auto back = readVolumeFile(folder / "v.nrrd");
  ASSERT_FALSE(back);
  EXPECT_EQ(sentence(back.error()),
            "Some voxels are not numbers (NaN or infinity). File: " + (folder / "v.nrrd").string() +
                ". Field: voxel 2,1,1. Found: NaN. Expected: finite values. Replace such voxels by "
                "the background value in the program that made the file.");
}

TEST(VolumeFiles, WholeFloatsBecomeInt16) {
  TestFolder folder;
  Volume v = test::float32Volume(test::obliqueGeometry(3, 3, 3));
  for (std::size_t i = 0; i < v.float32.size(); ++i) v.float32[i] = static_cast<float>(i) - 9.0F;
  ASSERT_TRUE(writeVolumeFile(v, folder / "v.nrrd"));
  const auto back = readVolumeFile(folder / "v.nrrd");
  ASSERT_TRUE(back);
  EXPECT_EQ(back->type, VoxelType::Int16);
  EXPECT_EQ(back->int16[0], -9);
}

TEST(VolumeFiles, ColourIsRefused) {
  TestFolder folder;
  test::writeBytes(folder / "v.mha",
                   std::string("ObjectType = Image\nNDims = 3\nBinaryData = True\nDimSize = 1 1 2\n"
                               "ElementNumberOfChannels = 3\nElementType = MET_UCHAR\n"
                               "ElementDataFile = LOCAL\n") +
                       "abcdef");
  const auto v = readVolumeFile(folder / "v.mha");
  ASSERT_FALSE(v);
  EXPECT_EQ(v.error().message, "The voxels are colours or vectors, not single values.");
  EXPECT_EQ(v.error().found, "3 values per voxel");
}

TEST(VolumeFiles, LabelsAbove255AreRefused) {
  TestFolder folder;
  Volume v = test::int16Volume(test::obliqueGeometry(2, 2, 2));
  v.int16 = {0, 1, 2, 255, 256, 0, 0, 0};
  ASSERT_TRUE(writeVolumeFile(v, folder / "v.mha"));
  const auto labels = readLabelFile(folder / "v.mha");
  ASSERT_FALSE(labels);
  EXPECT_EQ(labels.error().found, "256");
  EXPECT_EQ(labels.error().message, "The file holds values that are not labels.");
}

TEST(VolumeFiles, UnwritablePlaceIsTheMachinesFault) {
  TestFolder folder;
  test::writeBytes(folder / "plain", "x");
  const auto wrote = writeVolumeFile(test::int16Volume(test::obliqueGeometry(2, 2, 2)),
                                     folder / "plain" / "v.mha");
  ASSERT_FALSE(wrote);
  EXPECT_EQ(wrote.error().kind, ErrorKind::Machine);
  EXPECT_EQ(test::readBytes(folder / "plain"), "x");
}

/// What a full disk does, in a child process: no file may grow beyond 4 kB.
TEST(VolumeFiles, FullDiskLeavesNothing) {
  for (const char* name : {"v.mha", "v.nrrd", "v.nii", "v.nii.gz"}) {
    TestFolder folder;
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      ::signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{4096, 4096};
      ::setrlimit(RLIMIT_FSIZE, &limit);
      const auto wrote =
          writeVolumeFile(test::int16Volume(test::obliqueGeometry(64, 64, 8)), folder / name);
      ::_exit(!wrote && wrote.error().kind == ErrorKind::Machine ? 0 : 1);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << name;
    EXPECT_EQ(test::filesIn(folder.path()), 0U) << name;
  }
}

TEST(VolumeFiles, DemoMrIsReadInPatientSpace) {
  PALPATE_NEEDS(test::demoMr(), "Debian package mricron-data");
  const auto v = readVolumeFile(test::demoMr());
  ASSERT_TRUE(v) << sentence(v.error());
  EXPECT_EQ(v->geometry.dims, (std::array<std::int32_t, 3>{181, 217, 181}));
  // nibabel's affine of the same grid (ch2bet): origin and axes in LPS.
  EXPECT_LT((v->geometry.X_PV.translation() * 1e3 - Eigen::Vector3d(90, 125, -71)).norm(), 1e-3);
  EXPECT_LT(
      (v->geometry.X_PV.linear() - Eigen::Matrix3d(Eigen::Vector3d(-1, -1, 1).asDiagonal())).norm(),
      1e-6);
}

TEST(VolumeFiles, SharedVolumesEqualTheirReferences) {
  PALPATE_NEEDS(test::sharedData() / "volumes", "shared test data");
  std::vector<std::string> warnings;
  const auto ct = readVolumeFile(test::sharedData() / "volumes/ct_headsq.nrrd", &warnings);
  ASSERT_TRUE(ct) << sentence(ct.error());
  EXPECT_EQ(ct->geometry.dims, (std::array<std::int32_t, 3>{64, 64, 93}));
  EXPECT_EQ(valueRange(*ct), std::make_pair(0.0, 3926.0));
  EXPECT_EQ(warnings.size(), 1U) << "the file states no space";
  const auto mr = readVolumeFile(test::sharedData() / "volumes/mr_ch2bet.nii.gz");
  ASSERT_TRUE(mr) << sentence(mr.error());
  EXPECT_EQ(mr->geometry.dims, (std::array<std::int32_t, 3>{181, 217, 181}));
  EXPECT_EQ(valueRange(*mr), std::make_pair(0.0, 133.0));
  EXPECT_LT((mr->geometry.X_PV.translation() * 1e3 - Eigen::Vector3d(90, 125, -71)).norm(), 1e-3);
}

TEST(Volume, Sha256OfKnownBytes) {
  Volume v;
  v.geometry.dims = {3, 1, 1};
  v.int16 = {0x6261, 0x0063, 0};  // "abc\0\0\0": `printf 'abc\0\0\0' | sha256sum`
  EXPECT_EQ(voxelsSha256(v), "dd0b251b2bf91037a1e4fc8416a24ae00bcb9a8c252dc7e2361f2fc015f51c16");
}

}  // namespace
}  // namespace palpate
