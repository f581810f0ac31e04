#include "imaging/invesalius.h"

#include <bit>
#include <cstring>

#include "imaging/archive.h"
#include "imaging/invesalius_project.h"

namespace palpate {
namespace fs = std::filesystem;

bool isInvesaliusProject(const fs::path& file) {
  return isArchive(file) && archiveHolds(file, "main.plist");
}

Result<SeriesInfo> describeInvesalius(const fs::path& file) {
  const auto project = openInvesaliusProject(file);
  if (!project) return fail(project.error());
  SeriesInfo info;
  info.modality = project->modality;
  info.description = "InVesalius project";
  info.files = 1;
  info.importable = true;
  info.geometry = project->geometry;
  return info;
}

Result<ImportedScan> readInvesalius(const fs::path& file) {
  const auto project = openInvesaliusProject(file);
  if (!project) return fail(project.error());
  const GridGeometry& geometry = project->geometry;
  const auto bytes = readExactly(file, project->matrixFile,
                                 geometry.voxelCount() * sizeof(std::int16_t), "voxels");
  if (!bytes) return fail(bytes.error());
  static_assert(std::endian::native == std::endian::little);
  ImportedScan scan;
  scan.volume.geometry = geometry;
  scan.volume.modality = project->modality;
  scan.volume.int16.resize(geometry.voxelCount());
  const std::size_t rowBytes = static_cast<std::size_t>(geometry.dims[0]) * sizeof(std::int16_t);
  for (std::int32_t z = 0; z < geometry.dims[2]; ++z) {
    for (std::int32_t y = 0; y < geometry.dims[1]; ++y) {
      const std::size_t from = geometry.index(0, invesaliusRow(geometry, y), z);
      std::memcpy(scan.volume.int16.data() + geometry.index(0, y, z),
                  bytes->data() + from * sizeof(std::int16_t), rowBytes);
    }
  }
  scan.sourceFormat = "InVesalius";
  scan.description = "InVesalius project";
  scan.warnings.emplace_back(
      "The project stores no position in the patient: the volume is centred on the origin.");
  return scan;
}

}  // namespace palpate
