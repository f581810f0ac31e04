#pragma once
/// Writes a volume as a folder of DICOM images, for tests only: so that the import is tested where
/// no real DICOM data are.

#include <filesystem>
#include <functional>
#include <string>

#include "imaging/volume.h"

namespace palpate::test {

struct DicomWriterOptions {
  std::string seriesUid = "2.25.1001";
  std::string patientName = "Test^Patient";
  std::string description = "Written by a test";
  std::string imageType = {};                          ///< Left out when empty.
  std::string transferSyntax = "1.2.840.10008.1.2.1";  ///< Explicit little-endian; DCMTK writes it.
  double slope = 1.0, intercept = 0.0;  ///< Values are stored as (value - intercept) / slope.
  /// Slices to write, in this order; all when empty.
  std::vector<int> slices = {};
  /// Adds to the position of slice k, mm: tilt and gaps.
  std::function<Eigen::Vector3d(int)> shift_mm = {};
  std::string filePrefix = "image";
};

/// int16 volumes with whole stored values only. Throws std::runtime_error when it cannot.
void writeDicomSeries(const Volume& volume, const std::filesystem::path& folder,
                      const DicomWriterOptions& options = {});

}  // namespace palpate::test
