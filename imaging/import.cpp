#include "imaging/import.h"

#include <cstdio>
#include <random>

#include "imaging/dicom_import.h"
#include "imaging/dicom_list.h"
#include "imaging/invesalius.h"
#include "imaging/volume_files.h"
#include "imaging/volume_format.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

enum class Source { Volume, Invesalius, Dicom };

// Volume files and projects hold one volume; it is listed under this name.
const std::string kOnlyUid{"1"};

/// Random, so that nothing of the patient can be read from it.
std::string randomPseudonym() {
  std::random_device random;
  char text[16];
  std::snprintf(text, sizeof text, "Case-%04X", random() & 0xFFFFU);
  return text;
}

Result<Source> sourceOf(const fs::path& path) {
  std::error_code ec;
  const fs::file_status status = fs::status(path, ec);
  if (!fs::exists(status)) {
    return fail(inputRefused("There is no such file or folder.")
                    .inFile(path.string())
                    .advise("Check the path and its spelling."));
  }
  if (fs::is_directory(status)) return Source::Dicom;
  if (volumeFormatByContent(path)) return Source::Volume;
  if (isInvesaliusProject(path)) return Source::Invesalius;
  return Source::Dicom;
}

Result<void> refuseOtherUid(const ImportRequest& request) {
  if (!request.seriesUid || *request.seriesUid == kOnlyUid) return {};
  return fail(inputRefused("The file holds no such series.")
                  .inFile(request.path.string())
                  .wants("series 1")
                  .advise("Leave out --series: the file holds one volume."));
}

Result<SeriesInfo> describeVolumeFile(const fs::path& path) {
  auto geometry = readVolumeGeometry(path);
  if (!geometry) return fail(geometry.error());
  SeriesInfo info;
  info.description = std::string(formatName(*volumeFormatByContent(path))) + " volume";
  info.files = 1;
  info.importable = true;
  info.geometry = *geometry;
  return info;
}

Result<ImportedScan> importVolumeFile(const fs::path& path) {
  ImportedScan scan;
  auto volume = readVolumeFile(path, &scan.warnings);
  if (!volume) return fail(volume.error());
  scan.volume = std::move(*volume);
  scan.sourceFormat = formatName(*volumeFormatByContent(path));
  scan.description = scan.sourceFormat + " volume";
  return scan;
}

Result<ImportedScan> importOneVolume(Source source, const ImportRequest& request,
                                     const Progress& progress) {
  if (auto same = refuseOtherUid(request); !same) return fail(same.error());
  progress(0.1, "Reading the volume");
  return source == Source::Volume ? importVolumeFile(request.path) : readInvesalius(request.path);
}

void warnOfOneSlice(ImportedScan& scan) {
  if (scan.volume.geometry.dims[2] != 1) return;
  scan.warnings.emplace_back(
      "One slice only: it can be looked at, but not felt; a tree needs two slices or more.");
}

}  // namespace

Result<SeriesList> listSeries(const fs::path& path, const Progress& progress, bool thumbnails) {
  const auto source = sourceOf(path);
  if (!source) return fail(source.error());
  if (*source == Source::Dicom) return listDicomSeries(path, progress, thumbnails);
  auto info = *source == Source::Volume ? describeVolumeFile(path) : describeInvesalius(path);
  if (!info) return fail(info.error());
  info->uid = kOnlyUid;
  std::error_code ec;
  info->bytes = fs::file_size(path, ec);
  SeriesList list;
  list.series.push_back(std::move(*info));
  return list;
}

Result<ImportedScan> importScan(const ImportRequest& request, const Progress& progress) {
  const auto source = sourceOf(request.path);
  if (!source) return fail(source.error());
  if (progress.cancelled()) return fail(cancelled());
  auto scan = *source == Source::Dicom ? importDicom(request, progress)
                                       : importOneVolume(*source, request, progress);
  if (!scan) return scan;
  if (progress.cancelled()) return fail(cancelled());
  scan->pseudonym = randomPseudonym();
  warnOfOneSlice(*scan);
  progress(1.0, "Read");
  return scan;
}

}  // namespace palpate
