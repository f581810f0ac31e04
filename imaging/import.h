#pragma once
/// A scan in: DICOM (file, folder, DICOMDIR, zip, tar), InVesalius .inv3, NIfTI, NRRD, MetaImage.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "imaging/volume.h"

namespace palpate {

struct SeriesInfo {
  std::string uid, modality, description;
  std::string patientName;  ///< UTF-8; shown while a study is open, never stored or logged.
  std::size_t files = 0;
  bool importable = false;
  std::string reason;     ///< Why not, when not.
  GridGeometry geometry;  ///< Valid when importable.
};

struct SeriesList {
  std::vector<SeriesInfo> series;
  std::size_t skippedFiles = 0;  ///< Not DICOM images.
};

[[nodiscard]] Result<SeriesList> listSeries(const std::filesystem::path& path,
                                            const Progress& progress = {});

struct ImportRequest {
  std::filesystem::path path;
  std::optional<std::string> seriesUid = {};
  bool repairTilt = false, repairSpacing = false;
  bool keepNames = false;
};

struct ImportedScan {
  Volume volume;
  std::string sourceFormat;  ///< "DICOM", "InVesalius", "NIfTI", "NRRD", "MetaImage".
  std::string description;   ///< Series description, free of names.
  std::string pseudonym;     ///< "Case-7F3A": from a random number, never from the name.
  std::optional<std::string> patientName, patientId;  ///< Only with keepNames.
  std::vector<std::string> warnings, repairs;
  bool lossy = false;  ///< The source was compressed with loss.
};

/// Several volumes and no seriesUid, tilt or uneven spacing without leave to repair, and whatever
/// else would need a guess: refused.
[[nodiscard]] Result<ImportedScan> importScan(const ImportRequest& request,
                                              const Progress& progress = {});

}  // namespace palpate
