#pragma once
/// The voxels of one stack: decoded on all cores, rescaled, in slice order.

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "imaging/dicom_stack.h"
#include "imaging/volume.h"

namespace palpate {

struct LoadedStack {
  Volume volume;  ///< Geometry is the stack's.
  bool lossy = false;
};

/// int16 where every rescaled value is one, else float32 (interface.md, voxels_sha256).
[[nodiscard]] Result<LoadedStack> loadStack(const std::vector<DicomFile>& files,
                                            const DicomStack& stack, const Progress& progress);
/// By file and frame: equal for equal rescaled images only.
using ImageDigests = std::map<std::pair<std::size_t, std::size_t>, std::string>;
/// Decodes each file once, however many of its frames are asked for.
[[nodiscard]] Result<ImageDigests> imageDigests(const std::vector<DicomFile>& files,
                                                const std::vector<FrameRef>& frames);

}  // namespace palpate
