#pragma once
/// A scan in: DICOM (file, folder, DICOMDIR, zip, tar), InVesalius .inv3, NIfTI, NRRD, MetaImage.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "imaging/volume.h"

namespace palpate {

inline constexpr int kThumbnailSide = 64;  ///< Pixels, at most.

/// 8-bit grey, top row first.
struct GreyPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> grey;
};

struct SeriesInfo {
  std::string uid, modality, description;
  /// UTF-8; shown while a study is open, never stored or logged. The date as written: 20260131.
  std::string patientName, patientId, studyDate;
  std::size_t study = 0;  ///< Series with the same number are of one study.
  std::size_t files = 0;
  std::uintmax_t bytes = 0;  ///< Of the files.
  bool importable = false;
  std::string reason;                    ///< Why not, when not.
  std::string repair;                    ///< "tilt", "spacing" or both, where that would do.
  GridGeometry geometry;                 ///< Valid when importable or with a repair.
  std::optional<GreyPicture> thumbnail;  ///< Where asked for, and the images can be decoded.
};

struct SeriesList {
  std::vector<SeriesInfo> series;
  std::size_t skippedFiles = 0;  ///< Not DICOM images.
  std::vector<std::string> warnings;
};

[[nodiscard]] Result<SeriesList> listSeries(const std::filesystem::path& path,
                                            const Progress& progress = {}, bool thumbnails = false);

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
