#include "tests/fuzz/dicom_seeds.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcrleerg.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmjpeg/djencode.h>
#include <dcmtk/dcmjpeg/djrploss.h>
#include <dcmtk/dcmjpls/djencode.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "tests/imaging/dicom_bytes.h"
#include "tests/imaging/jpeg2000_writer.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using test::DicomBytes;
using test::element;
using test::number16;
using test::plainPixels;
using test::sequence;

std::string contentOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A plain file in another transfer syntax, by the toolkit.
std::string inSyntax(const std::string& plain, const char* uid, bool meta = true) {
  const fs::path file = fs::temp_directory_path() / ("palpate-seed-" + std::to_string(::getpid()));
  std::ofstream(file, std::ios::binary) << plain;
  const DcmXfer syntax(uid);
  DcmFileFormat format;
  if (format.loadFile(file.c_str()).bad()) throw std::runtime_error("a seed cannot be read");
  format.loadAllDataIntoMemory();
  if (format.getDataset()->chooseRepresentation(syntax.getXfer(), nullptr).bad() ||
      format
          .saveFile(file.c_str(), syntax.getXfer(), EET_ExplicitLength, EGL_recalcGL, EPD_noChange,
                    0, 0, meta ? EWM_fileformat : EWM_dataset)
          .bad()) {
    throw std::runtime_error(std::string("a seed cannot be written as ") + uid);
  }
  const std::string bytes = contentOf(file);
  fs::remove(file);
  return bytes;
}

DicomBytes plain() {
  DicomBytes d;
  d.pixels = plainPixels(128);
  return d;
}

DicomBytes eightBits() {
  DicomBytes d;
  d.bitsAllocated = d.bitsStored = 8;
  d.pixels = plainPixels(64, "OB");
  return d;
}

DicomBytes twelvePacked() {
  DicomBytes d;
  d.bitsAllocated = d.bitsStored = 12;
  d.rows = 7;
  d.pixels = plainPixels(84, "OB");
  return d;
}

DicomBytes thirtyTwoBits() {
  DicomBytes d;
  d.bitsAllocated = d.bitsStored = 32;
  d.isSigned = 1;
  d.pixels = plainPixels(256);
  return d;
}

DicomBytes withTable() {
  DicomBytes d = eightBits();
  d.beforePixels = sequence(
      0x00283000,
      {element(0x00283002, "US", test::little(16, 2) + test::little(4, 2) + test::little(16, 2)) +
       element(0x00283004, "LO", "HU") + element(0x00283006, "US", std::string(32, '\5'))});
  return d;
}

DicomBytes rescaled() {
  DicomBytes d = plain();
  d.beforePixels = element(0x00281052, "DS", "-1024.5") + element(0x00281053, "DS", "0.25");
  return d;
}

/// Three frames with their own places, echo times and contents; the rest is shared.
DicomBytes enhanced() {
  DicomBytes d;
  d.ownGeometry = false;
  d.frameCount = "3";
  std::vector<std::string> frames;
  for (const char* place : {"0\\0\\0", "0\\0\\2", "0\\0\\4"}) {
    frames.push_back(sequence(0x00189114, {element(0x00189082, "FD", std::string(8, '\0'))}) +
                     sequence(0x00209111, {element(0x00209056, "SH", "1") +
                                           element(0x00209128, "UL", test::little(1, 4))}) +
                     sequence(0x00209113, {element(0x00200032, "DS", place)}));
  }
  const std::string shared =
      sequence(0x00209116, {element(0x00200037, "DS", "1\\0\\0\\0\\1\\0")}) +
      sequence(0x00289110,
               {element(0x00180050, "DS", "2") + element(0x00280030, "DS", "0.5\\0.5")}) +
      sequence(0x00289145, {element(0x00281052, "DS", "-7") + element(0x00281053, "DS", "2")});
  d.beforePixels = sequence(0x52009229, {shared}) + sequence(0x52009230, frames);
  d.pixels = plainPixels(3 * 128);
  return d;
}

DicomBytes jpeg2000() {
  DicomBytes d;
  d.rows = d.columns = 16;
  d.pixels = test::encapsulated({test::encodeJpeg2000(16, 16)});
  return d;
}

DicomBytes inUtf8() {
  DicomBytes d = plain();
  d.beforePatient = element(0x0008103E, "LO",
                            "sch\xC3\xA4"
                            "del");
  d.frameCount = "1";
  return d;
}

std::string jpegLossy() {
  DJ_RPLossy quality(80);
  const fs::path file = fs::temp_directory_path() / ("palpate-seed-" + std::to_string(::getpid()));
  std::ofstream(file, std::ios::binary) << eightBits().file();
  DcmFileFormat format;
  (void)format.loadFile(file.c_str());
  if (format.getDataset()->chooseRepresentation(EXS_JPEGProcess1, &quality).bad() ||
      format.saveFile(file.c_str(), EXS_JPEGProcess1).bad()) {
    throw std::runtime_error("a seed cannot be written as JPEG");
  }
  const std::string bytes = contentOf(file);
  fs::remove(file);
  return bytes;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> dicomSeeds() {
  OFLog::configure(OFLogger::OFF_LOG_LEVEL);
  DcmRLEEncoderRegistration::registerCodecs();
  DJEncoderRegistration::registerCodecs();
  DJLSEncoderRegistration::registerCodecs();
  const std::string image = plain().file();
  return {{"explicit", image},
          {"implicit", inSyntax(image, test::kImplicitVr)},
          {"big_endian", inSyntax(image, "1.2.840.10008.1.2.2")},
          {"deflated", inSyntax(image, test::kDeflated)},
          {"no_preamble", inSyntax(image, test::kExplicitVr, false)},
          {"no_preamble_implicit", inSyntax(image, test::kImplicitVr, false)},
          {"rle", inSyntax(image, test::kRle)},
          {"rle_frames", inSyntax(enhanced().file(), test::kRle)},
          {"jpeg_lossless", inSyntax(image, test::kJpegLossless)},
          {"jpeg_lossless_any", inSyntax(image, "1.2.840.10008.1.2.4.57")},
          {"jpeg_baseline", jpegLossy()},
          {"jpeg_ls", inSyntax(eightBits().file(), test::kJpegLs)},
          {"jpeg_2000", jpeg2000().file(test::kJpeg2000)},
          {"enhanced", enhanced().file()},
          {"enhanced_implicit", inSyntax(enhanced().file(), test::kImplicitVr)},
          {"eight_bits", eightBits().file()},
          {"twelve_packed", twelvePacked().file()},
          {"thirty_two_bits", thirtyTwoBits().file()},
          {"modality_table", withTable().file()},
          {"rescaled", rescaled().file()},
          {"utf8", inUtf8().file()}};
}

}  // namespace palpate
