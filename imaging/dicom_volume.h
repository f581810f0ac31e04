#pragma once
/// The voxels of one stack: decoded on all cores, rescaled, in slice order.

#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "imaging/dicom_series.h"
#include "imaging/volume.h"

namespace palpate {

struct LoadedStack {
  Volume volume;  ///< Geometry is the stack's.
  bool lossy = false;
};

/// int16 where every rescaled value is one, else float32 (interface.md, voxels_sha256).
[[nodiscard]] Result<LoadedStack> loadStack(const std::vector<DicomFile>& files,
                                            const DicomStack& stack, const Progress& progress);
/// Whether two frames hold the same rescaled image.
[[nodiscard]] Result<bool> sameImage(const std::vector<DicomFile>& files, const FrameRef& a,
                                     const FrameRef& b);

}  // namespace palpate
