/// Labels through every format and back: the same voxels, names and colours.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "imaging/exchange/label_volume.h"
#include "imaging/volume_files.h"
#include "tests/imaging/exchange/exchange_samples.h"
#include "tests/imaging/volume_samples.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using test::expectRefusal;
using test::exportCase;
using test::makeCase;
using test::randomGeometry;
using test::randomLabels;
using test::sampleTable;
using test::TestFolder;

constexpr unsigned kSeeds = 12;

struct RoundTrip : testing::TestWithParam<const char*> {
  TestFolder folder;
};

/// Into an empty table, so that nothing comes from the case.
void expectSame(const FoundLabels& found, const LabelGrid& labels, bool named) {
  ASSERT_EQ(found.labels.size(), sampleTable().size());
  std::array<std::uint8_t, 256> becomes{};
  for (std::size_t r = 0; r < sampleTable().size(); ++r) {
    const LabelInfo& row = sampleTable()[r];
    const FoundLabel& label = found.labels[r];
    EXPECT_EQ(label.name, named ? row.name : "label-" + std::to_string(row.value));
    EXPECT_EQ(label.colour.has_value(), named);
    if (named) {
      EXPECT_EQ(*label.colour, row.colour);
    }
    becomes[label.value] = row.value;
  }
  std::vector<std::uint8_t> back;
  for (const std::uint8_t label : found.grid.labels) back.push_back(becomes[label]);
  EXPECT_EQ(back, labels.labels);
  EXPECT_EQ(found.grid.geometry.dims, labels.geometry.dims);
  EXPECT_EQ(found.grid.geometry.cornerDistance(labels.geometry), 0.0);
}

TEST_P(RoundTrip, KeepsEveryVoxelNameAndColour) {
  std::printf("seeds 1 to %u\n", kSeeds);
  const std::string ending = GetParam();
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const LabelGrid labels = randomLabels(randomGeometry(random), sampleTable(), random);
    const fs::path caseFolder = folder / ("case" + std::to_string(seed));
    makeCase(caseFolder, labels, sampleTable());
    const fs::path file = folder / (std::to_string(seed) + ending);
    const auto report = exportCase(caseFolder, file);
    ASSERT_TRUE(report) << sentence(report.error());
    EXPECT_EQ(report->labels.size(), 3U);
    const auto found = importLabels(file, labels.geometry, "");
    ASSERT_TRUE(found) << sentence(found.error());
    EXPECT_THAT(found->warnings, testing::IsEmpty());
    expectSame(*found, labels, ending != ".mha");
    // Back into the case itself: nothing may change, whatever numbers the file uses.
    if (ending == ".mha") continue;
    LabelGrid merged = labels;
    LabelTable table = sampleTable();
    std::vector<std::string> warnings;
    ASSERT_TRUE(mergeLabels(*found, merged, table, warnings));
    EXPECT_EQ(merged.labels, labels.labels);
    EXPECT_EQ(table.size(), sampleTable().size());
    EXPECT_THAT(warnings, testing::IsEmpty());
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrip,
                         testing::Values(".dcm", ".mha", ".nrrd", ".seg.nrrd", ".DCM"),
                         [](const auto& info) {
                           std::string name = std::to_string(info.index) + info.param;
                           std::erase(name, '.');
                           return name;
                         });

/// The same voxels with axes in another order and sense.
LabelGrid turned(const LabelGrid& grid, const std::array<std::size_t, 3>& order, unsigned flips) {
  const GridGeometry& g = grid.geometry;
  LabelGrid out;
  out.geometry = g;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  for (std::size_t a = 0; a < 3; ++a) {
    const auto from = static_cast<Eigen::Index>(order[a]);
    const auto to = static_cast<Eigen::Index>(a);
    const bool flip = (flips >> a & 1U) != 0;
    out.geometry.dims[a] = g.dims[order[a]];
    out.geometry.spacing[to] = g.spacing[from];
    out.geometry.X_PV.linear().col(to) = g.X_PV.linear().col(from) * (flip ? -1.0 : 1.0);
    if (flip) first[from] = g.dims[order[a]] - 1;
  }
  out.geometry.X_PV.translation() = g.X_PV * g.centre_V(first[0], first[1], first[2]);
  out.labels.resize(grid.labels.size());
  const auto& dims = out.geometry.dims;
  for (std::int32_t k = 0; k < dims[2]; ++k)
    for (std::int32_t j = 0; j < dims[1]; ++j)
      for (std::int32_t i = 0; i < dims[0]; ++i) {
        const std::array<std::int32_t, 3> at{i, j, k};
        std::array<std::int32_t, 3> from{};
        for (std::size_t a = 0; a < 3; ++a) {
          from[order[a]] = (flips >> a & 1U) != 0 ? dims[a] - 1 - at[a] : at[a];
        }
        out.labels[out.geometry.index(i, j, k)] = grid.at(from[0], from[1], from[2]);
      }
  return out;
}

TEST(LabelVolume, AxesInAnyOrderAndSenseAreTheSameVoxels) {
  TestFolder folder;
  std::mt19937 random(3);
  const LabelGrid labels = randomLabels(randomGeometry(random), sampleTable(), random);
  std::array<std::size_t, 3> order{0, 1, 2};
  do {
    for (unsigned flips = 0; flips < 8; ++flips) {
      for (const char* name : {"a.nrrd", "a.mha"}) {
        const fs::path file = folder / name;
        ASSERT_TRUE(writeLabelFile(turned(labels, order, flips), file));
        const auto found = readLabelVolume(file, labels.geometry);
        ASSERT_TRUE(found) << sentence(found.error());
        ASSERT_EQ(found->grid.labels, labels.labels) << order[0] << order[1] << " " << flips;
      }
    }
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(LabelVolume, APartOfTheVolumeIsPlacedAndTheRestIsBackground) {
  TestFolder folder;
  std::mt19937 random(4);
  const LabelGrid labels = randomLabels(randomGeometry(random, 2, 4), sampleTable(), random);
  LabelGrid part;
  part.geometry = labels.geometry;
  for (auto& n : part.geometry.dims) n -= 2;
  part.geometry.X_PV.translation() = labels.geometry.X_PV * labels.geometry.centre_V(1, 2, 0);
  part.labels.assign(part.geometry.voxelCount(), 9);
  ASSERT_TRUE(writeLabelFile(part, folder / "part.nrrd"));
  const auto found = readLabelVolume(folder / "part.nrrd", labels.geometry);
  ASSERT_TRUE(found) << sentence(found.error());
  EXPECT_EQ(found->labels.front().name, "label-9");
  for (std::int32_t k = 0; k < labels.geometry.dims[2]; ++k)
    for (std::int32_t j = 0; j < labels.geometry.dims[1]; ++j)
      for (std::int32_t i = 0; i < labels.geometry.dims[0]; ++i) {
        const bool inside = part.geometry.contains(i - 1, j - 2, k);
        ASSERT_EQ(found->grid.at(i, j, k), inside ? 9 : 0);
      }
}

struct WrongGeometry : testing::Test {
  TestFolder folder;
  GridGeometry geometry = test::obliqueGeometry(7, 5, 3);

  Result<FoundLabels> read(const GridGeometry& stated) {
    LabelGrid grid{stated, std::vector<std::uint8_t>(stated.voxelCount(), 1)};
    EXPECT_TRUE(writeLabelFile(grid, folder / "wrong.nrrd"));
    return readLabelVolume(folder / "wrong.nrrd", geometry);
  }
};

TEST_F(WrongGeometry, OtherSpacing) {
  GridGeometry stated = geometry;
  stated.spacing[1] *= 2.0;
  expectRefusal(read(stated), folder / "wrong.nrrd",
                {"The labels have other axes or another spacing than the case's volume.",
                 "origin, directions", "an axis of (0, 2, 0) voxels of the case",
                 "axes of one voxel along the volume's own, in any order and sense"});
}

TEST_F(WrongGeometry, BetweenVoxels) {
  GridGeometry stated = geometry;
  stated.X_PV.translation() = geometry.X_PV * geometry.centre_V(0.25, 0, 0);
  expectRefusal(read(stated), folder / "wrong.nrrd",
                {"The labels lie between the voxels of the case's volume.", "origin, directions",
                 "voxels up to 0.25 voxels off", "at most 0.01 voxels"});
  stated.X_PV.translation() = geometry.X_PV * geometry.centre_V(0.009, 0, 0);
  EXPECT_TRUE(read(stated));
  stated.X_PV.translation() = geometry.X_PV * geometry.centre_V(0.011, 0, 0);
  EXPECT_FALSE(read(stated));
}

TEST_F(WrongGeometry, OutOfTheVolume) {
  GridGeometry stated = geometry;
  stated.X_PV.translation() = geometry.X_PV * geometry.centre_V(0, 1, 0);
  expectRefusal(read(stated), folder / "wrong.nrrd",
                {"The labels reach out of the case's volume.", "origin, directions",
                 "voxels from (0, 1, 0) to (6, 5, 2)", "from (0, 0, 0) to (6, 4, 2)"});
}

TEST(LabelVolume, CutShortIsRefused) {
  TestFolder folder;
  std::mt19937 random(5);
  const LabelGrid labels = randomLabels(randomGeometry(random, 3, 5), sampleTable(), random);
  for (const char* name : {"a.mha", "a.nrrd"}) {
    ASSERT_TRUE(writeLabelVolume(labels, sampleTable(), folder / name));
    const std::string bytes = test::readBytes(folder / name);
    test::writeBytes(folder / name, bytes.substr(0, bytes.size() - 20));
    const auto found = readLabelVolume(folder / name, labels.geometry);
    ASSERT_FALSE(found);
    EXPECT_THAT(found.error().message, testing::EndsWith("file ends before its last voxel."));
  }
}

TEST(LabelVolume, LayersAreRefused) {
  TestFolder folder;
  test::writeBytes(folder / "a.seg.nrrd",
                   "NRRD0004\ntype: unsigned char\ndimension: 4\nspace: left-posterior-superior\n"
                   "sizes: 2 2 2 2\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n"
                   "kinds: list domain domain domain\nencoding: raw\nspace origin: (0,0,0)\n\n"
                   "0123456789abcdef");
  expectRefusal(readLabelVolume(folder / "a.seg.nrrd", test::obliqueGeometry(2, 2, 2)),
                folder / "a.seg.nrrd",
                {"The file holds its segments in layers.", "sizes", "2 layers",
                 "one layer, in which no segments overlap"});
}

TEST(ImportLabels, NameRenamesOneLabelAndChoosesAmongSeveral) {
  TestFolder folder;
  std::mt19937 random(6);
  const LabelGrid labels = randomLabels(randomGeometry(random), sampleTable(), random);
  ASSERT_TRUE(writeLabelVolume(labels, sampleTable(), folder / "a.seg.nrrd"));
  const auto one = importLabels(folder / "a.seg.nrrd", labels.geometry, "Nervus facialis");
  ASSERT_TRUE(one) << sentence(one.error());
  ASSERT_EQ(one->labels.size(), 1U);
  EXPECT_EQ(one->labels.front().value, 7);
  expectRefusal(importLabels(folder / "a.seg.nrrd", labels.geometry, "liver"),
                folder / "a.seg.nrrd",
                {"The file has no label of that name.", "--label", "liver",
                 "one of bone, Nervus facialis, Öhr \"links\""});
  LabelGrid single = labels;
  for (auto& label : single.labels) label = label == 7 ? 7 : 0;
  ASSERT_TRUE(writeLabelFile(single, folder / "single.mha"));
  const auto renamed = importLabels(folder / "single.mha", labels.geometry, "liver");
  ASSERT_TRUE(renamed);
  EXPECT_EQ(renamed->labels.front().name, "liver");
}

TEST(ImportLabels, NewLabelsAreAddedAndOldOnesOfTheNameReplaced) {
  const GridGeometry g = test::obliqueGeometry(4, 1, 1);
  LabelGrid labels{g, {1, 1, 2, 0}};
  LabelTable table{{.name = "bone", .value = 1, .material = "tooth"},
                   {.name = "x", .value = 2, .material = "skin"}};
  FoundLabels found;
  found.grid = {g, {0, 5, 2, 2}};
  found.labels = {{"brain", 2, std::nullopt}, {"bone", 5, std::nullopt}};
  std::vector<std::string> warnings;
  ASSERT_TRUE(mergeLabels(found, labels, table, warnings));
  EXPECT_EQ(labels.labels, (std::vector<std::uint8_t>{0, 1, 3, 3}));
  EXPECT_EQ(table[0].material, "tooth");
  EXPECT_EQ(table[2].name, "brain");
  EXPECT_EQ(table[2].material, "brain");
  EXPECT_THAT(warnings, testing::IsEmpty());
  found.labels[0].name = "liver";
  ASSERT_TRUE(mergeLabels(found, labels, table, warnings));
  EXPECT_EQ(table[3].material, "bone");
  EXPECT_THAT(warnings, testing::ElementsAre("The material of liver is a guess (bone): choose the "
                                             "right one in the window, or in labels.toml."));
}

TEST(JoinLabels, SaysWhatItReplacedAndAddedAndStartsFromNothingToo) {
  TestFolder folder;
  const GridGeometry g = test::obliqueGeometry(4, 1, 1);
  const LabelTable rows{{.name = "bone", .value = 1}, {.name = "tooth", .value = 2}};
  const fs::path file = folder / "a.nrrd";
  ASSERT_TRUE(writeLabelVolume({g, {0, 2, 1, 1}}, rows, file));
  const auto first = joinLabels(file, g, "", {});
  ASSERT_TRUE(first) << sentence(first.error());
  EXPECT_EQ(first->state.labels.labels, (std::vector<std::uint8_t>{0, 2, 1, 1}));
  EXPECT_THAT(first->added, testing::ElementsAre("bone", "tooth"));
  EXPECT_THAT(first->replaced, testing::IsEmpty());
  const LabelState before{{g, {3, 1, 0, 0}}, {{.name = "x", .value = 3}, {.name = "bone"}}};
  const auto second = joinLabels(file, g, "bone", before);
  ASSERT_TRUE(second) << sentence(second.error());
  EXPECT_EQ(second->state.labels.labels, (std::vector<std::uint8_t>{3, 0, 1, 1}));
  EXPECT_THAT(second->replaced, testing::ElementsAre("bone"));
  EXPECT_THAT(second->added, testing::IsEmpty());
}

/// The window exports what it has in memory: the file is the command's, but for random numbers.
TEST(ExportLabels, FromMemoryGivesTheFileOfTheCase) {
  TestFolder folder;
  std::mt19937 random(5);
  const LabelGrid labels = randomLabels(randomGeometry(random), sampleTable(), random);
  makeCase(folder / "case", labels, sampleTable());
  const auto info = readCaseInfo(folder / "case");
  const auto state = readCaseLabelState(folder / "case");
  ASSERT_TRUE(info && state);
  for (const char* name : {"a.nrrd", "a.mha"}) {
    for (const std::vector<std::string>& only : {std::vector<std::string>{}, {"bone"}}) {
      const fs::path one = folder / ("one-" + std::to_string(only.size()) + name);
      const fs::path other = folder / ("other-" + std::to_string(only.size()) + name);
      ASSERT_TRUE(exportLabels({folder / "case", one, only, false, "1"}));
      ASSERT_TRUE(exportLabels({folder / "case", other, only, false, "1"}, *info, state->labels,
                               state->table));
      EXPECT_EQ(test::readBytes(one), test::readBytes(other)) << one;
    }
  }
  expectRefusal(
      exportLabels({folder / "case", folder / "case/a.nrrd", {}, true, "1"}, *info, labels,
                   sampleTable()),
      folder / "case/a.nrrd",
      {"The case's own folder is no place for an export.", "", "", "a place outside the case"});
}

TEST(ExportLabels, RefusesWhatIsThereAndWhatIsNot) {
  TestFolder folder;
  std::mt19937 random(7);
  const LabelGrid labels = randomLabels(randomGeometry(random), sampleTable(), random);
  makeCase(folder / "case", labels, sampleTable());
  test::writeBytes(folder / "there.nrrd", "mine");
  expectRefusal(exportCase(folder / "case", folder / "there.nrrd"), folder / "there.nrrd",
                {"The output exists.", "", "", "a new name"});
  EXPECT_EQ(test::readBytes(folder / "there.nrrd"), "mine");
  EXPECT_TRUE(exportCase(folder / "case", folder / "there.nrrd", {}, true));
  expectRefusal(
      exportCase(folder / "case", folder / "case" / "x.nrrd"), folder / "case" / "x.nrrd",
      {"The case's own folder is no place for an export.", "", "", "a place outside the case"});
  const auto unknown = exportCase(folder / "case", folder / "x.nrrd", {"liver"});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().message, "The case has no label of that name.");
  const auto ending = exportCase(folder / "case", folder / "x.vtk");
  ASSERT_FALSE(ending);
  EXPECT_EQ(ending.error().kind, ErrorKind::Usage);
  EXPECT_EQ(ending.error().expected, ".dcm, .mha, .nrrd, .seg.nrrd, .stl, .ply or .obj");
  const auto nowhere = exportCase(folder / "case", folder / "there.nrrd" / "x.dcm");
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().kind, ErrorKind::Machine);
  const auto several = exportCase(folder / "case", folder / "x.stl");
  ASSERT_FALSE(several);
  EXPECT_EQ(several.error().message, "A surface file holds one label.");
  EXPECT_EQ(test::filesIn(folder.path()), 2U);
}

TEST(ExportLabels, AChosenLabelIsAloneInTheFile) {
  TestFolder folder;
  std::mt19937 random(8);
  const LabelGrid labels = randomLabels(randomGeometry(random), sampleTable(), random);
  makeCase(folder / "case", labels, sampleTable());
  for (const char* name : {"x.dcm", "x.nrrd", "x.mha"}) {
    const auto report = exportCase(folder / "case", folder / name, {"Nervus facialis"});
    ASSERT_TRUE(report) << sentence(report.error());
    ASSERT_EQ(report->labels.size(), 1U);
    const auto found = importLabels(folder / name, labels.geometry, "");
    ASSERT_TRUE(found) << sentence(found.error());
    ASSERT_EQ(found->labels.size(), 1U);
    for (std::size_t i = 0; i < labels.labels.size(); ++i) {
      ASSERT_EQ(found->grid.labels[i] != 0, labels.labels[i] == 7);
    }
  }
}

TEST(ImportLabels, OtherKindsOfFilesAreRefused) {
  TestFolder folder;
  test::writeBytes(folder / "a.vtk", "text");
  expectRefusal(importLabels(folder / "a.vtk", test::obliqueGeometry(2, 2, 2), ""),
                folder / "a.vtk",
                {"Labels cannot be read from a file of this kind.", "", ".vtk",
                 ".dcm, .mha, .mhd, .nrrd, .nhdr, .stl, .ply or .obj"});
  expectRefusal(importLabels(folder / "nothing.dcm", test::obliqueGeometry(2, 2, 2), ""),
                folder / "nothing.dcm", {"There is no such file.", "", "", ""});
}

}  // namespace
}  // namespace palpate
