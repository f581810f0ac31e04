#include "tests/imaging/dicom_writer.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcrleerg.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmjpeg/djencode.h>
#include <dcmtk/dcmjpls/djencode.h>

#include <cstdio>
#include <mutex>
#include <numeric>
#include <stdexcept>

namespace palpate::test {
namespace {

std::string number(double value) {
  // DICOM's decimal strings hold 16 characters.
  for (int digits = 14; digits > 3; --digits) {
    char text[40];
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    if (std::string(text).size() <= 16) return text;
  }
  throw std::runtime_error("number too long for DICOM");
}

std::string numbers(const Eigen::Vector3d& v) {
  return number(v.x()) + "\\" + number(v.y()) + "\\" + number(v.z());
}

void put(DcmDataset& dataset, const DcmTagKey& tag, const std::string& value) {
  if (dataset.putAndInsertString(tag, value.c_str()).bad()) {
    throw std::runtime_error("DCMTK refused a value");
  }
}

void registerEncoders() {
  static std::once_flag once;
  std::call_once(once, [] {
    DcmRLEEncoderRegistration::registerCodecs();
    DJEncoderRegistration::registerCodecs();
    DJLSEncoderRegistration::registerCodecs();
  });
}

}  // namespace

void writeDicomSeries(const Volume& volume, const std::filesystem::path& folder,
                      const DicomWriterOptions& options) {
  registerEncoders();
  std::filesystem::create_directories(folder);
  const GridGeometry& g = volume.geometry;
  std::vector<int> slices = options.slices;
  if (slices.empty()) {
    slices.resize(static_cast<std::size_t>(g.dims[2]));
    std::iota(slices.begin(), slices.end(), 0);
  }
  const std::size_t pixels = static_cast<std::size_t>(g.dims[0] * g.dims[1]);
  const DcmXfer syntax(options.transferSyntax.c_str());
  int written = 0;
  for (const int k : slices) {
    DcmFileFormat file;
    DcmDataset& d = *file.getDataset();
    put(d, DCM_SOPClassUID, UID_CTImageStorage);
    put(d, DCM_SOPInstanceUID, options.seriesUid + "." + std::to_string(written + 1));
    put(d, DCM_StudyInstanceUID, "2.25.1000");
    put(d, DCM_SeriesInstanceUID, options.seriesUid);
    put(d, DCM_Modality, volume.modality.empty() ? "CT" : volume.modality);
    if (!options.imageType.empty()) put(d, DCM_ImageType, options.imageType);
    put(d, DCM_PatientName, options.patientName);
    put(d, DCM_SeriesDescription, options.description);
    // Not in the order of the positions: the import must not use it.
    put(d, DCM_InstanceNumber, std::to_string((k * 7919) % 1009));
    Eigen::Vector3d p_mm = g.X_PV * g.centre_V(0, 0, k) * 1e3;
    if (options.shift_mm) p_mm += options.shift_mm(k);
    put(d, DCM_ImagePositionPatient, numbers(p_mm));
    const Eigen::Matrix3d R = g.X_PV.linear();
    put(d, DCM_ImageOrientationPatient, numbers(R.col(0)) + "\\" + numbers(R.col(1)));
    put(d, DCM_PixelSpacing, number(g.spacing.y() * 1e3) + "\\" + number(g.spacing.x() * 1e3));
    put(d, DCM_SliceThickness, number(g.spacing.z() * 1e3));
    put(d, DCM_RescaleSlope, number(options.slope));
    put(d, DCM_RescaleIntercept, number(options.intercept));
    put(d, DCM_PhotometricInterpretation, "MONOCHROME2");
    d.putAndInsertUint16(DCM_SamplesPerPixel, 1);
    d.putAndInsertUint16(DCM_Rows, static_cast<Uint16>(g.dims[1]));
    d.putAndInsertUint16(DCM_Columns, static_cast<Uint16>(g.dims[0]));
    d.putAndInsertUint16(DCM_BitsAllocated, 16);
    d.putAndInsertUint16(DCM_BitsStored, 16);
    d.putAndInsertUint16(DCM_HighBit, 15);
    d.putAndInsertUint16(DCM_PixelRepresentation, 1);
    std::vector<std::int16_t> stored(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
      const double value = volume.int16[static_cast<std::size_t>(k) * pixels + i];
      stored[i] = static_cast<std::int16_t>((value - options.intercept) / options.slope);
    }
    d.putAndInsertUint16Array(DCM_PixelData, reinterpret_cast<const Uint16*>(stored.data()),
                              pixels);
    if (d.chooseRepresentation(syntax.getXfer(), nullptr).bad()) {
      throw std::runtime_error("DCMTK cannot write this transfer syntax");
    }
    // Names in another order than the slices, and without an ending.
    char name[32];
    std::snprintf(name, sizeof name, "%s%05d", options.filePrefix.c_str(),
                  (written * 611) % 100003);
    const auto path = folder / name;
    if (file.saveFile(path.c_str(), syntax.getXfer()).bad()) {
      throw std::runtime_error("cannot write " + path.string());
    }
    ++written;
  }
}

}  // namespace palpate::test
