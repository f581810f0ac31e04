// No patient name, identifier or UID leaves the scan unless asked for: not in a case, a session, a
// log or a result.

#include <dcmtk/dcmdata/dctk.h>
#include <gtest/gtest.h>

#include "tests/app/program_run.h"

namespace palpate::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kName = "Zwetschgenbaum^Adelheid";
constexpr const char* kSurname = "Zwetschgenbaum";
constexpr const char* kIdentifier = "PAT-9182736455";
constexpr const char* kPhysician = "Quastenflosser^Otto";
constexpr const char* kStudyUid = "1.2.826.0.1.3680043.9.7777.4711";

/// One slice of a 40 x 40 x 40 scan with a block of bone, with everything that names a person.
void writeSlice(const fs::path& file, int k) {
  DcmFileFormat format;
  DcmDataset& data = *format.getDataset();
  const std::string uid = std::string(kStudyUid) + ".2." + std::to_string(k + 1);
  data.putAndInsertString(DCM_SOPClassUID, UID_CTImageStorage);
  data.putAndInsertString(DCM_SOPInstanceUID, uid.c_str());
  data.putAndInsertString(DCM_StudyInstanceUID, kStudyUid);
  data.putAndInsertString(DCM_SeriesInstanceUID, (std::string(kStudyUid) + ".1").c_str());
  data.putAndInsertString(DCM_FrameOfReferenceUID, (std::string(kStudyUid) + ".3").c_str());
  data.putAndInsertString(DCM_PatientName, kName);
  data.putAndInsertString(DCM_PatientID, kIdentifier);
  data.putAndInsertString(DCM_ReferringPhysicianName, kPhysician);
  data.putAndInsertString(DCM_SeriesDescription, (std::string("Head ") + kSurname).c_str());
  data.putAndInsertString(DCM_Modality, "CT");
  data.putAndInsertString(DCM_InstanceNumber, std::to_string(k + 1).c_str());
  data.putAndInsertString(DCM_ImageOrientationPatient, "1\\0\\0\\0\\1\\0");
  data.putAndInsertString(DCM_ImagePositionPatient, ("0\\0\\" + std::to_string(k)).c_str());
  data.putAndInsertString(DCM_PixelSpacing, "1\\1");
  data.putAndInsertString(DCM_SliceThickness, "1");
  data.putAndInsertString(DCM_PhotometricInterpretation, "MONOCHROME2");
  data.putAndInsertString(DCM_RescaleSlope, "1");
  data.putAndInsertString(DCM_RescaleIntercept, "0");
  data.putAndInsertUint16(DCM_SamplesPerPixel, 1);
  data.putAndInsertUint16(DCM_Rows, 40);
  data.putAndInsertUint16(DCM_Columns, 40);
  data.putAndInsertUint16(DCM_BitsAllocated, 16);
  data.putAndInsertUint16(DCM_BitsStored, 16);
  data.putAndInsertUint16(DCM_HighBit, 15);
  data.putAndInsertUint16(DCM_PixelRepresentation, 1);
  std::vector<Uint16> pixels(1600, static_cast<Uint16>(-1000));
  for (int j = 10; j < 30; ++j) {
    for (int i = 10; i < 30; ++i) {
      if (k >= 10 && k < 30) pixels[static_cast<std::size_t>(j * 40 + i)] = 1000;
    }
  }
  data.putAndInsertUint16Array(DCM_PixelData, pixels.data(), pixels.size());
  const OFCondition saved = format.saveFile(file.c_str(), EXS_LittleEndianExplicit);
  ASSERT_TRUE(saved.good()) << saved.text();
}

bool holds(const std::string& text, const std::string& word) {
  return text.find(word) != std::string::npos;
}

class Privacy : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(folder / "scan");
    for (int k = 0; k < 40; ++k) {
      writeSlice(folder / "scan" / ("slice" + std::to_string(k) + ".dcm"), k);
    }
  }
  /// Runs and looks through both outputs.
  void run(const std::vector<std::string>& arguments) {
    const ProgramRun done = palpate(arguments);
    ASSERT_EQ(done.exitCode, 0) << done.err;
    for (const char* word : {kSurname, "Adelheid", kIdentifier, "Quastenflosser"}) {
      EXPECT_FALSE(holds(done.out, word)) << arguments[0] << " prints " << word;
      EXPECT_FALSE(holds(done.err, word)) << arguments[0] << " logs " << word;
    }
    EXPECT_FALSE(holds(done.err, kStudyUid)) << arguments[0] << " logs a UID";
  }
  std::string at(const std::string& name) { return (folder / name).string(); }
  TempFolder folder;
};

TEST_F(Privacy, NothingThatTheChainWritesNamesThePatient) {
  run({"import", at("scan"), "--out", at("case"), "--json"});
  run({"segment", at("case"), "--preset", "ct-bone", "--json"});
  run({"tree", at("case"), "--label", "bone", "--json"});
  run({"simulate", at("case"), "--seconds", "1", "--record", at("s.palpate"), "--samples",
       at("s.csv"), "--json"});
  run({"replay", at("s.palpate"), "--json"});
  for (const std::string& name : listing(folder.path())) {
    if (name.rfind("scan", 0) == 0 || !fs::is_regular_file(folder / name)) continue;
    const std::string content = contentOf(folder / name);
    for (const char* word : {kSurname, "Adelheid", kIdentifier, "Quastenflosser", kStudyUid}) {
      EXPECT_FALSE(holds(content, word)) << name << " holds " << word;
    }
  }
  EXPECT_FALSE(holds(contentOf(folder / "s.palpate"), folder.path().string()))
      << "the session holds a path";
}

TEST_F(Privacy, NamesAreKeptOnlyWhereAskedFor) {
  const ProgramRun kept =
      palpate({"import", at("scan"), "--out", at("case"), "--keep-names", "--json"});
  ASSERT_EQ(kept.exitCode, 0) << kept.err;
  EXPECT_TRUE(holds(contentOf(folder / "case/case.toml"), kSurname));
  EXPECT_FALSE(holds(kept.err, kSurname)) << "still not in a log";
}

}  // namespace
}  // namespace palpate::test
