#include "imaging/dicom_import.h"

#include <algorithm>
#include <cstdio>

#include "core/base/counted.h"
#include "core/base/progress_part.h"
#include "imaging/dicom_choice.h"
#include "imaging/dicom_series.h"
#include "imaging/dicom_volume.h"
#include "imaging/regular_stack.h"

namespace palpate {
namespace {

/// The description goes into the case, so it must not carry a part of the name or the identifier.
std::string withoutNames(const DicomFile& file) {
  return holdsName(file.description, file) ? std::string() : file.description;
}

Result<void> refuseUnrepaired(const DicomStack& stack, const ImportRequest& request) {
  const bool tilt = stack.shape.tilted() && !request.repairTilt;
  const bool spacing = stack.shape.uneven() && !request.repairSpacing;
  if (!tilt && !spacing) return {};
  const std::string words = stack.shape.repairs();
  return fail(
      inputRefused("The series is not a regular box: " + stack.problem.reason + ".")
          .inFile(request.path.string())
          .inField(tilt ? "gantry tilt" : "slice spacing")
          .wants("slices at even distances, straight above each other")
          .advise("Import it with --repair " + words + " to have it resampled to a regular grid."));
}

std::vector<Eigen::Vector3d> positionsOf(const std::vector<DicomFile>& files,
                                         const DicomStack& stack) {
  std::vector<Eigen::Vector3d> positions;
  for (const FrameRef& ref : stack.slices) {
    positions.push_back(files[ref.file].frames[ref.frame].position_mm);
  }
  return positions;
}

Result<void> repair(const std::vector<DicomFile>& files, const DicomStack& stack,
                    ImportedScan& scan, const Progress& progress) {
  auto regular = makeRegularStack(scan.volume, positionsOf(files, stack), progress);
  if (!regular) return fail(regular.error());
  char grid[96];
  char moved[64];
  std::snprintf(grid, sizeof grid, "Resampled to a regular grid of %d slices %.4g mm apart",
                regular->volume.geometry.dims[2], regular->volume.geometry.spacing.z() * 1e3);
  std::snprintf(moved, sizeof moved, "Largest displacement of a slice: %.2f mm.",
                regular->largestDisplacement_mm);
  scan.repairs.push_back(std::string(grid) + "; before, " + stack.problem.reason + ". " + moved);
  scan.volume = std::move(regular->volume);
  return {};
}

void addWarnings(const std::vector<DicomStack>& stacks, const DicomStack& stack,
                 const DicomFile& first, ImportedScan& scan) {
  scan.warnings.insert(scan.warnings.end(), stack.warnings.begin(), stack.warnings.end());
  if (stacks.size() > 1) {
    scan.warnings.push_back(
        "Left out: " + counted(stacks.size() - 1, "other image stack", "other image stacks") +
        " (scouts or other series).");
  }
  if (scan.volume.modality != first.modality) {
    const std::string& unit = first.frames.front().rescaleType;
    std::string why;
    if (!first.imageKind.empty()) why = "image type " + first.imageKind;
    if (!unit.empty()) {
      if (!why.empty()) why += ", ";
      why += "unit " + (unit == "US" ? "unspecified" : unit);
    }
    scan.warnings.push_back("The header says CT, but not that the values are Hounsfield units (" +
                            why +
                            "). It is taken as an image of another modality (OT); no CT preset "
                            "fits it.");
  }
  if (first.mosaic) {
    scan.warnings.emplace_back(
        "The image is a mosaic: slices side by side, not a place in the patient. Have the scanner "
        "or the archive send them one by one.");
  }
  if (first.photometric == "MONOCHROME1") {
    scan.warnings.emplace_back(
        "The scanner shows small values bright (MONOCHROME1); the values are kept as they are.");
  }
  if (scan.lossy) {
    scan.warnings.emplace_back(
        "The images were compressed with loss: fine detail is not reliable.");
  }
}

}  // namespace

Result<ImportedScan> importDicom(const ImportRequest& request, const Progress& progress) {
  const auto found = scanDicom(request.path, shareOf(progress, 0.0, 0.3));
  if (!found) return fail(found.error());
  const auto stacks = stacksOf(found->files);
  const auto chosen = chooseStack(stacks, *found, request);
  if (!chosen) return fail(chosen.error());
  const DicomStack& stack = **chosen;
  if (auto regular = refuseUnrepaired(stack, request); !regular) return fail(regular.error());
  auto loaded =
      loadStack(found->files, stack, shareOf(progress, 0.3, stack.needsRepair ? 0.7 : 1.0));
  if (!loaded) return fail(loaded.error());
  const DicomFile& first = found->files[stack.slices.front().file];
  ImportedScan scan;
  scan.volume = std::move(loaded->volume);
  scan.lossy = loaded->lossy;
  scan.sourceFormat = "DICOM";
  scan.description = withoutNames(first);
  if (stack.needsRepair) {
    if (auto done = repair(found->files, stack, scan, shareOf(progress, 0.7, 1.0)); !done) {
      return fail(done.error());
    }
  }
  scan.warnings = found->warnings;
  addWarnings(stacks, stack, first, scan);
  if (request.keepNames) {
    scan.patientName = first.patientName;
    scan.patientId = first.patientId;
  }
  return scan;
}

}  // namespace palpate
