#pragma once
/// A DICOM segmentation (SEG) of a case's labels, through DCMTK's dcmseg.
///
/// BINARY, a segment a label, a frame a slice that holds voxels of it; not compressed. The file
/// names the case's pseudonym as the patient, whatever the case knows, and no image of the scan's
/// own series: archives hold the two apart until someone who may joins them.

#include <filesystem>
#include <string>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/voxels/label_grid.h"

namespace palpate {

struct SegOrigin {
  std::string pseudonym;  ///< Of the case.
  /// What makes exports of one case share study and frame of reference: the volume's hash.
  std::string fingerprint;
  std::string programVersion;
  bool lossy = false;  ///< The scan had been compressed with loss.
};

/// Writes the labels of `table`; a label without voxels becomes a segment without frames. Whole or
/// not at all, read back before it gets its name. Refused: no voxels at all, names longer than 64
/// characters or with a backslash, more than 65535 rows or columns.
[[nodiscard]] Result<void> writeDicomSeg(const LabelGrid& labels, const LabelTable& table,
                                         const SegOrigin& origin, const std::filesystem::path& file,
                                         const Progress& progress = {});

}  // namespace palpate
