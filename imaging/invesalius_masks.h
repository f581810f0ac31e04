#pragma once
/// The masks of an InVesalius project (.inv3), each as a label volume on the grid of its voxels.
///
/// mask_N.plist names a mask, its colour and threshold; mask_N.dat holds a byte a voxel, with one
/// more slice, row and column at the low side. What lies there marks slices that InVesalius has
/// worked out: it does so when a slice is first shown, and before it uses the whole mask, so that a
/// slice that is not marked may hold nothing. Such slices are worked out here as it does: voxels
/// within the threshold are selected, and what was painted (253, 254) or erased (1, 2) stays.
/// Selected are values above 127, which is what it draws, counts and contours.
///
/// Masks of one project overlap (each is a threshold of its own), so each is read as a volume.

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/voxels/label_grid.h"
#include "imaging/segmentation.h"

namespace palpate {

struct InvesaliusMask {
  std::string name;  ///< As its user called it.
  std::array<std::uint8_t, 3> colour{255, 255, 255};
  ThresholdRange threshold;
  std::string voxelFile;  ///< Member of the project.
};

/// In the order of their numbers; empty where the project has none. Refuses (InputRefused) a
/// project or mask whose fields are not what the format says: a mask must have the size of the
/// project's voxels.
[[nodiscard]] Result<std::vector<InvesaliusMask>> listInvesaliusMasks(
    const std::filesystem::path& file);

/// 1 where the mask is selected; the geometry is what readInvesalius() gives the volume. The size
/// is checked against the project's before memory is taken. Refuses a mask that is missing or of
/// another length. Reads the project's voxels only where a slice is not marked.
[[nodiscard]] Result<LabelGrid> readInvesaliusMask(const std::filesystem::path& file,
                                                   const InvesaliusMask& mask);

}  // namespace palpate
