#include "imaging/case_folder.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "imaging/segmentation.h"
#include "tests/imaging/demo_files.h"
#include "tests/imaging/volume_samples.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using test::TestFolder;

ImportedScan sampleScan() {
  ImportedScan scan;
  scan.volume = test::int16Volume(test::obliqueGeometry(9, 8, 7));
  scan.volume.modality = "CT";
  scan.sourceFormat = "DICOM";
  scan.description = "Head \"thin\"\nslices";
  scan.pseudonym = "Case-0A1B";
  scan.warnings = {"One thing.", "Another."};
  scan.repairs = {"Resampled."};
  scan.lossy = true;
  return scan;
}

LabelGrid sampleLabels(const Volume& volume) {
  LabelGrid labels;
  labels.geometry = volume.geometry;
  labels.labels.assign(volume.size(), 0);
  labels.labels[3] = 1;
  labels.labels[4] = 7;
  return labels;
}

const LabelTable kTable{
    {.name = "bone", .value = 1},
    {.name = "nerve \"VII\"", .value = 7, .colour = {255, 0, 9}, .material = "nerve"}};

TEST(Case, KeepsAllOfTheScan) {
  TestFolder folder;
  const ImportedScan scan = sampleScan();
  const auto wrote = writeNewCase(folder / "case", scan);
  ASSERT_TRUE(wrote) << sentence(wrote.error());
  const auto info = readCaseInfo(folder / "case");
  ASSERT_TRUE(info) << sentence(info.error());
  EXPECT_EQ(info->pseudonym, scan.pseudonym);
  EXPECT_EQ(info->description, scan.description);
  EXPECT_EQ(info->modality, "CT");
  EXPECT_EQ(info->sourceFormat, "DICOM");
  EXPECT_EQ(info->warnings, scan.warnings);
  EXPECT_EQ(info->repairs, scan.repairs);
  EXPECT_TRUE(info->lossy);
  EXPECT_FALSE(info->patientName.has_value());
  EXPECT_EQ(info->voxelsSha256, voxelsSha256(scan.volume));
  EXPECT_LT(info->geometry.cornerDistance(scan.volume.geometry), 1e-12);
  const auto volume = readCaseVolume(folder / "case");
  ASSERT_TRUE(volume) << sentence(volume.error());
  EXPECT_EQ(volume->int16, scan.volume.int16);
  EXPECT_EQ(volume->modality, "CT");
  EXPECT_LT(volume->geometry.cornerDistance(scan.volume.geometry), 1e-12);
}

TEST(Case, IsPrivateAndHoldsOnlyItsFiles) {
  TestFolder folder;
  ASSERT_TRUE(writeNewCase(folder / "case", sampleScan()));
  EXPECT_EQ(fs::status(folder / "case").permissions(), fs::perms::owner_all);
  EXPECT_EQ(test::filesIn(folder / "case"), 2U);
  EXPECT_EQ(test::filesIn(folder.path()), 1U);
}

TEST(Case, NamesAreStoredOnlyWhenKept) {
  TestFolder folder;
  ImportedScan scan = sampleScan();
  ASSERT_TRUE(writeNewCase(folder / "without", scan));
  scan.patientName = "Müller^Änne";
  scan.patientId = "4711";
  ASSERT_TRUE(writeNewCase(folder / "with", scan));
  const auto info = readCaseInfo(folder / "with");
  ASSERT_TRUE(info);
  EXPECT_EQ(info->patientName, "Müller^Änne");
  EXPECT_EQ(info->patientId, "4711");
  EXPECT_EQ(test::readBytes(folder / "without" / "case.toml").find("patient_"), std::string::npos);
}

TEST(Case, ReplacesACaseAndAnEmptyFolderButNothingElse) {
  TestFolder folder;
  ImportedScan scan = sampleScan();
  fs::create_directory(folder / "empty");
  ASSERT_TRUE(writeNewCase(folder / "empty", scan));
  scan.pseudonym = "Case-FFFF";
  ASSERT_TRUE(writeNewCase(folder / "empty" / "", scan)) << "a slash at the end changes nothing";
  EXPECT_EQ(readCaseInfo(folder / "empty")->pseudonym, "Case-FFFF");
  EXPECT_EQ(test::filesIn(folder.path()), 1U) << "the old case is gone";

  fs::create_directory(folder / "photos");
  test::writeBytes(folder / "photos" / "a.png", "x");
  const auto refused = writeNewCase(folder / "photos", scan);
  ASSERT_FALSE(refused);
  EXPECT_EQ(sentence(refused.error()),
            "The output exists and is not a Palpate case. File: " + (folder / "photos").string() +
                ". Expected: a new name, an empty folder or a case to replace. Choose another name "
                "for the case.");
  EXPECT_EQ(test::filesIn(folder / "photos"), 1U);
}

TEST(Case, UnwritablePlaceIsTheMachinesFault) {
  TestFolder folder;
  test::writeBytes(folder / "plain", "x");
  const auto wrote = writeNewCase(folder / "plain" / "case", sampleScan());
  ASSERT_FALSE(wrote);
  EXPECT_EQ(exitCode(wrote.error().kind), 4);
}

TEST(Case, FullDiskLeavesTheOldCaseAndNothingElse) {
  TestFolder folder;
  ASSERT_TRUE(writeNewCase(folder / "case", sampleScan()));
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{4096, 4096};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    ImportedScan big = sampleScan();
    big.volume = test::int16Volume(test::obliqueGeometry(64, 64, 4));
    const auto wrote = writeNewCase(folder / "case", big);
    ::_exit(!wrote && wrote.error().kind == ErrorKind::Machine ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  EXPECT_EQ(test::filesIn(folder.path()), 1U);
  EXPECT_TRUE(readCaseVolume(folder / "case"));
}

TEST(Case, MissingAndForeignFoldersAreRefused) {
  TestFolder folder;
  const auto missing = readCaseInfo(folder / "none");
  ASSERT_FALSE(missing);
  EXPECT_EQ(sentence(missing.error()),
            "There is no such case. File: " + (folder / "none").string() +
                ". Expected: a folder with case.toml. Make a case with: palpate import SCAN --out "
                "CASE");
  const auto foreign = readCaseInfo(folder.path());
  ASSERT_FALSE(foreign);
  EXPECT_EQ(foreign.error().message, "This is not a Palpate case.");
}

/// Replaces one text of case.toml.
void spoil(const fs::path& file, const std::string& from, const std::string& to) {
  std::string text = test::readBytes(file);
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from << " in\n" << text;
  text.replace(at, from.size(), to);
  test::writeBytes(file, text);
}

TEST(Case, DamagedInfoIsRefusedByField) {
  TestFolder folder;
  const fs::path file = folder / "case" / "case.toml";
  const auto refusal = [&](const std::string& from, const std::string& to) {
    EXPECT_TRUE(writeNewCase(folder / "case", sampleScan()));
    spoil(file, from, to);
    const auto info = readCaseInfo(folder / "case");
    EXPECT_FALSE(info);
    return info ? std::string() : sentence(info.error());
  };
  const std::string start =
      "The case is damaged or from another version of Palpate. File: " + file.string();
  const std::string end = " Import the scan again.";
  EXPECT_EQ(refusal("version = 1", "version = 2"),
            start + ". Field: version. Found: 2. Expected: 1." + end);
  EXPECT_EQ(refusal("modality = 'CT'", "colour = 'red'"),
            start + ". Field: source.modality. Found: nothing. Expected: a text." + end);
  EXPECT_EQ(refusal("lossy = true", "lossy = true\nflavour = 1"),
            start +
                ". Field: source.flavour. Found: a key that this version does not know. "
                "Expected: no such key." +
                end);
  EXPECT_EQ(refusal("dims = [ 9, 8, 7 ]", "dims = [ 9, 8 ]"),
            start + ". Field: volume.dims. Found: other values. Expected: 3 numbers." + end);
  EXPECT_EQ(
      refusal("dims = [ 9, 8, 7 ]", "dims = [ 9, 8, -7 ]"),
      start + ". Field: volume.dims. Found: other values. Expected: three counts of voxels." + end);
  EXPECT_TRUE(refusal("version = 1", "version = ")
                  .starts_with("The case is damaged: case.toml is not TOML. File: "));
}

TEST(Case, VolumeOfAnotherCaseIsRefused) {
  TestFolder folder;
  ASSERT_TRUE(writeNewCase(folder / "a", sampleScan()));
  ImportedScan other = sampleScan();
  other.volume.int16[17] = static_cast<std::int16_t>(other.volume.int16[17] ^ 1);
  ASSERT_TRUE(writeNewCase(folder / "b", other));
  fs::copy_file(folder / "b" / "volume.mha", folder / "a" / "volume.mha",
                fs::copy_options::overwrite_existing);
  const auto volume = readCaseVolume(folder / "a");
  ASSERT_FALSE(volume);
  EXPECT_EQ(volume.error().message,
            "The file does not belong to this case, or was changed since the import.");
  EXPECT_EQ(volume.error().field, "voxels");
}

TEST(CaseLabels, AreKeptWithTheirTable) {
  TestFolder folder;
  const ImportedScan scan = sampleScan();
  ASSERT_TRUE(writeNewCase(folder / "case", scan));
  EXPECT_FALSE(caseHasLabels(folder / "case"));
  const LabelGrid labels = sampleLabels(scan.volume);
  const auto wrote = writeCaseLabels(folder / "case", labels, kTable);
  ASSERT_TRUE(wrote) << sentence(wrote.error());
  EXPECT_TRUE(caseHasLabels(folder / "case"));
  const auto back = readCaseLabels(folder / "case");
  ASSERT_TRUE(back) << sentence(back.error());
  EXPECT_EQ(back->labels, labels.labels);
  const auto table = readCaseLabelTable(folder / "case");
  ASSERT_TRUE(table) << sentence(table.error());
  ASSERT_EQ(table->size(), 2U);
  EXPECT_EQ((*table)[1].name, "nerve \"VII\"");
  EXPECT_EQ((*table)[1].value, 7);
  EXPECT_EQ((*table)[1].colour, (std::array<std::uint8_t, 3>{255, 0, 9}));
  EXPECT_EQ((*table)[1].material, "nerve");
  EXPECT_EQ(test::filesIn(folder / "case"), 4U);
}

TEST(CaseLabels, CaseWithoutLabelsNamesTheCommand) {
  TestFolder folder;
  ASSERT_TRUE(writeNewCase(folder / "case", sampleScan()));
  for (const auto& error :
       {readCaseLabels(folder / "case").error(), readCaseLabelTable(folder / "case").error()}) {
    EXPECT_EQ(sentence(error),
              "The case has no labels yet. File: " + (folder / "case").string() +
                  ". Expected: labels.mha and labels.toml. Make them with: palpate segment CASE "
                  "--preset ct-bone");
    EXPECT_EQ(exitCode(error.kind), 3);
  }
}

TEST(CaseLabels, UnknownKeysAndValuesAreRefusedByLine) {
  TestFolder folder;
  ASSERT_TRUE(writeNewCase(folder / "case", sampleScan()));
  const fs::path file = folder / "case" / "labels.toml";
  const auto refusal = [&](const std::string& text) {
    EXPECT_TRUE(writeCaseLabels(folder / "case", sampleLabels(sampleScan().volume), kTable));
    test::writeBytes(file, text);
    const auto table = readCaseLabelTable(folder / "case");
    EXPECT_FALSE(table);
    return table ? std::string() : sentence(table.error());
  };
  const std::string row = "[[label]]\nname = \"bone\"\nvalue = 1\ncolour = [1, 2, 3]\n";
  const std::string start = "The table of labels cannot be used. File: " + file.string();
  const std::string end = " Correct labels.toml, or segment again.";
  EXPECT_EQ(refusal(row + "material = \"bone\"\nstiffness = 3\n"),
            start +
                ". Field: line 6, stiffness. Found: an unknown key. Expected: name, value, "
                "colour or material." +
                end);
  EXPECT_EQ(
      refusal("[[label]]\nname = \"bone\"\nvalue = 256\ncolour = [1, 2, 3]\nmaterial = \"b\""),
      start + ". Field: line 1, value. Found: 256. Expected: a whole number from 1 to 255." + end);
  EXPECT_EQ(refusal(row + "material = \"b\"\n" + row + "material = \"b\"\n"),
            "Two labels share a name or a value, or one has none. File: " + file.string() +
                ". Field: bone. Found: value 1. Expected: names and values (1 to 255) that occur "
                "once. Give each label its own name and value.");
}

TEST(CaseLabels, ValueWithoutANameIsRefused) {
  TestFolder folder;
  const ImportedScan scan = sampleScan();
  ASSERT_TRUE(writeNewCase(folder / "case", scan));
  const auto wrote =
      writeCaseLabels(folder / "case", sampleLabels(scan.volume), {LabelInfo{.name = "bone"}});
  ASSERT_FALSE(wrote);
  EXPECT_EQ(wrote.error().found, "value 7");
  EXPECT_FALSE(caseHasLabels(folder / "case"));
}

TEST(CaseLabels, GridOfAnotherVolumeIsRefused) {
  TestFolder folder;
  const ImportedScan scan = sampleScan();
  ASSERT_TRUE(writeNewCase(folder / "case", scan));
  LabelGrid labels = sampleLabels(scan.volume);
  labels.geometry.X_PV.translation().x() += 1e-3;
  EXPECT_FALSE(writeCaseLabels(folder / "case", labels, kTable));
}

}  // namespace
}  // namespace palpate
