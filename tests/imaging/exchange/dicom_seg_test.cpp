/// DICOM segmentations: what is written, what is read, and what is refused in which words.

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <functional>

#include "imaging/exchange/cielab.h"
#include "imaging/exchange/dicom_uid.h"
#include "imaging/exchange/seg_read.h"
#include "imaging/exchange/seg_write.h"
#include "imaging/exchange/segment_codes.h"
#include "tests/imaging/exchange/exchange_samples.h"
#include "tests/imaging/volume_samples.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using test::expectRefusal;
using test::sampleTable;
using test::TestFolder;

constexpr const char* kCopyAgain = "Copy the file again";
const SegOrigin kOrigin{"Case-0A1B", "0123abcd", "0.0", false};

/// 5 x 3 x 3 voxels: not a whole number of bytes a frame, so that frames share bytes.
struct Seg : testing::Test {
  TestFolder folder;
  fs::path file = folder / "labels.dcm";
  LabelGrid labels;

  void SetUp() override {
    std::mt19937 random(11);
    labels = test::randomLabels(test::obliqueGeometry(5, 3, 3), sampleTable(), random);
    const auto written = writeDicomSeg(labels, sampleTable(), kOrigin, file);
    ASSERT_TRUE(written) << sentence(written.error());
  }
  void edit(const std::function<void(DcmDataset&)>& change) const {
    DcmFileFormat format;
    ASSERT_TRUE(format.loadFile(file.c_str()).good());
    format.loadAllDataIntoMemory();
    change(*format.getDataset());
    ASSERT_TRUE(format.saveFile(file.c_str(), EXS_LittleEndianExplicit).good());
  }
  static DcmItem& frame(DcmDataset& dataset, long n) {
    DcmItem* item = nullptr;
    EXPECT_TRUE(
        dataset.findAndGetSequenceItem(DCM_PerFrameFunctionalGroupsSequence, item, n).good());
    return *item;
  }
  static DcmItem& group(DcmItem& item, const DcmTagKey& tag) {
    DcmItem* found = nullptr;
    EXPECT_TRUE(item.findAndGetSequenceItem(tag, found, 0).good());
    return *found;
  }
  [[nodiscard]] Result<FoundLabels> read() const { return readDicomSeg(file, labels.geometry); }
  void refused(const test::Refusal& refusal) const { expectRefusal(read(), file, refusal); }
};

TEST_F(Seg, HoldsThePseudonymAndNoIdentifierOfMachineOrTime) {
  DcmFileFormat format;
  ASSERT_TRUE(format.loadFile(file.c_str()).good());
  DcmDataset& dataset = *format.getDataset();
  OFString text;
  for (const DcmTagKey& tag : {DCM_PatientName, DCM_PatientID}) {
    EXPECT_TRUE(dataset.findAndGetOFString(tag, text).good());
    EXPECT_STREQ(text.c_str(), "Case-0A1B");
  }
  for (const DcmTagKey& tag :
       {DCM_SOPInstanceUID, DCM_SeriesInstanceUID, DCM_StudyInstanceUID, DCM_FrameOfReferenceUID}) {
    EXPECT_TRUE(dataset.findAndGetOFString(tag, text).good());
    EXPECT_EQ(text.substr(0, 5), "2.25.");
    EXPECT_LE(text.size(), 64U);
  }
}

TEST_F(Seg, TwoExportsShareTheFrameOfReferenceOnly) {
  ASSERT_TRUE(writeDicomSeg(labels, sampleTable(), kOrigin, folder / "again.dcm"));
  const auto uid = [](const fs::path& from, const DcmTagKey& tag) {
    DcmFileFormat format;
    OFString text;
    EXPECT_TRUE(format.loadFile(from.c_str()).good());
    EXPECT_TRUE(format.getDataset()->findAndGetOFString(tag, text).good());
    return std::string(text.c_str());
  };
  for (const DcmTagKey& tag : {DCM_FrameOfReferenceUID, DCM_StudyInstanceUID}) {
    EXPECT_EQ(uid(file, tag), uid(folder / "again.dcm", tag));
  }
  for (const DcmTagKey& tag : {DCM_SOPInstanceUID, DCM_SeriesInstanceUID}) {
    EXPECT_NE(uid(file, tag), uid(folder / "again.dcm", tag));
  }
}

TEST_F(Seg, IsReadWhateverItsNameAndWhateverTheOrderOfFrames) {
  fs::rename(file, folder / "IM000001");
  const auto found = importLabels(folder / "IM000001", labels.geometry, "");
  ASSERT_TRUE(found) << sentence(found.error());
  EXPECT_EQ(found->labels.size(), 3U);
}

TEST_F(Seg, AFrameTurnedRoundLandsOnTheSameVoxels) {
  const auto before = read();
  ASSERT_TRUE(before);
  // Rows the other way: the pixels of each frame reversed, its first pixel the last one.
  edit([this](DcmDataset& dataset) {
    const Uint8* bytes = nullptr;
    ASSERT_TRUE(dataset.findAndGetUint8Array(DCM_PixelData, bytes).good());
    DcmItem& shared = group(dataset, DCM_SharedFunctionalGroupsSequence);
    DcmItem& orientation = group(shared, DCM_PlaneOrientationSequence);
    OFString cosines;
    std::string turned;
    for (unsigned c = 0; c < 6; ++c) {
      Float64 value = 0.0;
      ASSERT_TRUE(orientation.findAndGetFloat64(DCM_ImageOrientationPatient, value, c).good());
      char text[32];
      std::snprintf(text, sizeof text, "%s%.13g", c == 0 ? "" : "\\", -value);
      turned += text;
    }
    orientation.putAndInsertString(DCM_ImageOrientationPatient, turned.c_str());
    Sint32 frames = 0;
    ASSERT_TRUE(dataset.findAndGetSint32(DCM_NumberOfFrames, frames).good());
    std::vector<Uint8> out((static_cast<std::size_t>(frames) * 15 + 7) / 8 + 1, 0);
    for (Sint32 f = 0; f < frames; ++f) {
      DcmItem& position = group(frame(dataset, f), DCM_PlanePositionSequence);
      Eigen::Vector3d p_mm;
      for (unsigned c = 0; c < 3; ++c) {
        ASSERT_TRUE(position.findAndGetFloat64(DCM_ImagePositionPatient, p_mm[c], c).good());
      }
      const auto& g = labels.geometry;
      p_mm += g.X_PV.linear() * g.centre_V(4, 2, 0) * 1e3;
      char text[64];
      std::snprintf(text, sizeof text, "%.10g\\%.10g\\%.10g", p_mm[0], p_mm[1], p_mm[2]);
      position.putAndInsertString(DCM_ImagePositionPatient, text);
      for (std::size_t i = 0; i < 15; ++i) {
        const std::size_t from = static_cast<std::size_t>(f) * 15 + i;
        const std::size_t to = static_cast<std::size_t>(f) * 15 + 14 - i;
        out[to / 8] |= static_cast<Uint8>((bytes[from / 8] >> (from % 8) & 1U) << (to % 8));
      }
    }
    out.resize((out.size() - 1) / 2 * 2 + 2);
    dataset.putAndInsertUint8Array(DCM_PixelData, out.data(), out.size());
  });
  const auto after = read();
  ASSERT_TRUE(after) << sentence(after.error());
  EXPECT_EQ(after->grid.labels, before->grid.labels);
}

TEST_F(Seg, WhereSegmentsOverlapTheLaterWinsAndTheVoxelsAreCounted) {
  LabelGrid two{test::obliqueGeometry(4, 1, 1), {1, 1, 7, 7}};
  const LabelTable table{sampleTable()[0], sampleTable()[1]};
  ASSERT_TRUE(writeDicomSeg(two, table, kOrigin, file));
  edit([](DcmDataset& dataset) {
    const Uint8 bits[2] = {0b11101110, 0};  // first frame: voxels 1 to 3, second: 1 to 3
    dataset.putAndInsertUint8Array(DCM_PixelData, bits, 2);
  });
  const auto found = readDicomSeg(file, two.geometry);
  ASSERT_TRUE(found) << sentence(found.error());
  EXPECT_EQ(found->grid.labels, (std::vector<std::uint8_t>{0, 2, 2, 2}));
  EXPECT_THAT(found->warnings,
              testing::ElementsAre("Segments overlap in 3 voxels; the later segment has them.",
                                   "1 of the file's 2 labels hold no voxels and are left out."));
}

TEST_F(Seg, FractionalIsTakenFromOneHalfUp) {
  LabelGrid one{test::obliqueGeometry(4, 1, 1), {1, 1, 1, 1}};
  ASSERT_TRUE(writeDicomSeg(one, {sampleTable()[0]}, kOrigin, file));
  edit([](DcmDataset& dataset) {
    const Uint8 values[4] = {0, 99, 100, 200};
    dataset.putAndInsertString(DCM_SegmentationType, "FRACTIONAL");
    dataset.putAndInsertUint16(DCM_MaximumFractionalValue, 200);
    dataset.putAndInsertUint16(DCM_BitsAllocated, 8);
    dataset.putAndInsertUint8Array(DCM_PixelData, values, 4);
  });
  const auto found = readDicomSeg(file, one.geometry);
  ASSERT_TRUE(found) << sentence(found.error());
  EXPECT_EQ(found->grid.labels, (std::vector<std::uint8_t>{0, 0, 1, 1}));
  EXPECT_THAT(found->warnings, testing::ElementsAre("The segmentation is fractional: voxels of one "
                                                    "half and more are taken, the others not."));
}

TEST_F(Seg, OtherObjectIsRefused) {
  edit([](DcmDataset& d) { d.putAndInsertString(DCM_SOPClassUID, UID_CTImageStorage); });
  refused({"The DICOM file is not a segmentation.", "SOPClassUID", "CTImageStorage",
           "SegmentationStorage"});
}

TEST_F(Seg, OtherKindIsRefused) {
  edit([](DcmDataset& d) { d.putAndInsertString(DCM_SegmentationType, "LABELMAP"); });
  refused({"The segmentation is of a kind that Palpate does not read.", "SegmentationType",
           "LABELMAP", "BINARY or FRACTIONAL"});
}

TEST_F(Seg, SegmentThatIsNotDescribedIsRefused) {
  edit([](DcmDataset& d) {
    group(frame(d, 1), DCM_SegmentIdentificationSequence)
        .putAndInsertUint16(DCM_ReferencedSegmentNumber, 9);
  });
  refused({"A frame is of a segment that the file does not describe.",
           "ReferencedSegmentNumber of frame 2", "9", "the number of a segment of the file"});
}

TEST_F(Seg, NumberOfTwoSegmentsIsRefused) {
  edit([](DcmDataset& d) {
    DcmItem* segment = nullptr;
    ASSERT_TRUE(d.findAndGetSequenceItem(DCM_SegmentSequence, segment, 1).good());
    segment->putAndInsertUint16(DCM_SegmentNumber, 1);
  });
  refused({"A segment has no number of its own.", "SegmentNumber of segment 2", "1",
           "a number from 1 that no other segment has"});
}

TEST_F(Seg, NoSegmentsIsRefused) {
  edit([](DcmDataset& d) { d.findAndDeleteElement(DCM_SegmentSequence); });
  refused({"The segmentation does not have a number of segments that fits a case.",
           "SegmentSequence", "0 segments", "1 to 255"});
}

TEST_F(Seg, FrameWithoutAPlaceIsRefused) {
  edit([](DcmDataset& d) {
    group(frame(d, 2), DCM_PlanePositionSequence).findAndDeleteElement(DCM_ImagePositionPatient);
  });
  refused({"A frame of the segmentation does not say where it lies.",
           "ImagePositionPatient of frame 3", "nothing usable", "three numbers"});
}

TEST_F(Seg, FrameOfAnotherScanIsRefused) {
  edit([](DcmDataset& d) {
    group(frame(d, 0), DCM_PlanePositionSequence)
        .putAndInsertString(DCM_ImagePositionPatient, "1000\\1000\\1000");
  });
  const auto found = read();
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().message, "The labels lie between the voxels of the case's volume.");
  EXPECT_EQ(found.error().field,
            "ImagePositionPatient, ImageOrientationPatient, PixelSpacing of frame 1");
}

TEST_F(Seg, OtherSpacingIsRefused) {
  edit([](DcmDataset& d) {
    group(group(d, DCM_SharedFunctionalGroupsSequence), DCM_PixelMeasuresSequence)
        .putAndInsertString(DCM_PixelSpacing, "3\\3");
  });
  const auto found = read();
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().message,
            "The labels have other axes or another spacing than the case's volume.");
}

TEST_F(Seg, MoreFramesThanPixelsAreRefusedBeforeMemoryIsTaken) {
  edit([](DcmDataset& d) { d.putAndInsertString(DCM_NumberOfFrames, "2147483647"); });
  refused({"The segmentation holds fewer pixels than it states.", "PixelData", "16 bytes",
           "4026531839 bytes"});
}

TEST_F(Seg, ImpossibleSizesAreRefused) {
  edit([](DcmDataset& d) { d.putAndInsertUint16(DCM_Rows, 0); });
  const auto found = read();
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().message, "The segmentation states an impossible size.");
  EXPECT_EQ(found.error().field, "Rows, Columns, NumberOfFrames");
}

TEST_F(Seg, FramesThatAreNotDescribedAreRefused) {
  edit([](DcmDataset& d) {
    DcmSequenceOfItems* frames = nullptr;
    ASSERT_TRUE(d.findAndGetSequence(DCM_PerFrameFunctionalGroupsSequence, frames).good());
    delete frames->remove(0UL);
  });
  const auto found = read();
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().message, "The segmentation does not describe each of its frames.");
}

TEST_F(Seg, CutShortIsRefusedAtEveryLength) {
  const std::string bytes = test::readBytes(file);
  for (std::size_t n = 0; n < bytes.size(); n += 7) {
    test::writeAgain(file, bytes.substr(0, n));
    const auto found = read();
    ASSERT_FALSE(found) << n << " bytes";
    EXPECT_EQ(found.error().kind, ErrorKind::InputRefused);
    EXPECT_TRUE(found.error().advice);
  }
  test::writeBytes(file, bytes.substr(0, bytes.size() - 4));
  refused({"The DICOM file is damaged or cut short.", "", "", ""});
  EXPECT_THAT(*read().error().advice, testing::StartsWith(kCopyAgain));
}

TEST_F(Seg, ADamagedByteNeitherCrashesNorHangs) {
  std::mt19937 random(test::damageSeed());
  const std::string bytes = test::readBytes(file);
  const auto start = std::chrono::steady_clock::now();
  std::size_t refusals = 0;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(random());
    test::writeAgain(file, damaged);
    const auto found = read();
    if (!found) {
      ++refusals;
      EXPECT_EQ(found.error().kind, ErrorKind::InputRefused) << "byte " << at;
      continue;
    }
    for (const std::uint8_t label : found->grid.labels) ASSERT_LE(label, 3) << "byte " << at;
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  std::printf("%zu files, %zu refused, %.1f s\n", bytes.size(), refusals, took.count());
  EXPECT_GT(refusals, bytes.size() / 20);
}

TEST(SegWrite, RefusesWhatDicomCannotHold) {
  TestFolder folder;
  LabelGrid labels{test::obliqueGeometry(2, 1, 1), {1, 0}};
  const auto refusal = [&](const std::string& name) {
    const auto written =
        writeDicomSeg(labels, {{.name = name, .value = 1}}, kOrigin, folder / "x.dcm");
    return written ? std::string() : written.error().message;
  };
  EXPECT_EQ(refusal(std::string(65, 'a')), "A label's name does not fit into DICOM.");
  EXPECT_EQ(refusal("a\\b"), "A label's name does not fit into DICOM.");
  EXPECT_EQ(test::filesIn(folder.path()), 0U);
  std::string cyrillic;
  for (int i = 0; i < 64; ++i) cyrillic += "ж";
  EXPECT_EQ(refusal(cyrillic), "");
  const auto found = readDicomSeg(folder / "x.dcm", labels.geometry);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->labels.front().name, cyrillic);
  labels.labels = {0, 0};
  EXPECT_EQ(refusal("bone"), "The labels hold no voxels.");
}

TEST(Cielab, WhiteIsWhiteAndColoursComeBack) {
  // PS3.3 C.10.7.1.1: L* 100 is 65535; a* and b* 0 are 0x8080.
  EXPECT_EQ(dicomLabOfRgb({255, 255, 255}), (std::array<std::uint16_t, 3>{65535, 0x8080, 0x8080}));
  EXPECT_EQ(dicomLabOfRgb({0, 0, 0}), (std::array<std::uint16_t, 3>{0, 0x8080, 0x8080}));
  // sRGB red under D50 is Lab 54.29, 80.81, 69.89 (ICC's sRGB profile; a tenth is 26 steps).
  const auto red = dicomLabOfRgb({255, 0, 0});
  EXPECT_NEAR(red[0] * 100.0 / 65535.0, 54.29, 0.1);
  EXPECT_NEAR(red[1] * 255.0 / 65535.0 - 128.0, 80.81, 0.1);
  EXPECT_NEAR(red[2] * 255.0 / 65535.0 - 128.0, 69.89, 0.1);
  for (int r = 0; r < 256; r += 15)
    for (int g = 0; g < 256; g += 15)
      for (int b = 0; b < 256; b += 15) {
        const std::array<std::uint8_t, 3> rgb{static_cast<std::uint8_t>(r),
                                              static_cast<std::uint8_t>(g),
                                              static_cast<std::uint8_t>(b)};
        ASSERT_EQ(rgbOfDicomLab(dicomLabOfRgb(rgb)), rgb);
      }
}

TEST(SegmentCodes, NamesThatSayNothingAreTissue) {
  EXPECT_STREQ(segmentCodes("Bone").type.value, "272673000");
  EXPECT_STREQ(segmentCodes("soft tissue").type.value, "87784001");
  EXPECT_STREQ(segmentCodes("selection").type.meaning, "Tissue");
}

TEST(DicomUid, IsAUuidInDecimal) {
  EXPECT_EQ(uidOf("a"), uidOf("a"));
  EXPECT_NE(uidOf("a"), uidOf("b"));
  EXPECT_NE(randomUid(), randomUid());
  for (int i = 0; i < 100; ++i) {
    const std::string uid = randomUid();
    EXPECT_LE(uid.size(), 44U);
    EXPECT_NE(uid[5], '0');
  }
}

}  // namespace
}  // namespace palpate
