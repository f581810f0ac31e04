#pragma once
/// From a volume to a label: presets, thresholds, largest part, small islands.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/voxels/label_grid.h"
#include "imaging/volume.h"

namespace palpate {

/// Inclusive on both ends, in the volume's values (HU for CT).
struct ThresholdRange {
  double low = 226, high = 3071;
};

struct Preset {
  std::string name;      ///< "ct-bone"
  std::string title;     ///< "Bone (CT)"
  std::string modality;  ///< "CT", "MR"
  std::string label;     ///< Default label name.
  std::array<std::uint8_t, 3> colour{227, 211, 177};
  std::string material;
  std::optional<ThresholdRange> range;  ///< Empty: computed from the volume (MR: Otsu).
};

/// ct-bone (226..3071), ct-soft-tissue, ct-skin, ct-air, mr-brain, mr-tissue.
[[nodiscard]] const std::vector<Preset>& segmentationPresets();
/// The preset of that name, or the first that makes that label; null where there is none.
[[nodiscard]] const Preset* presetNamed(const std::string& name);
[[nodiscard]] const Preset* presetOfLabel(const std::string& label);
/// The preset's range for this volume; refuses an unknown name with the list, and a wrong modality
/// is a warning for the caller to show (compare Preset::modality).
[[nodiscard]] Result<ThresholdRange> presetRange(const std::string& preset, const Volume& volume);

struct SegmentRequest {
  ThresholdRange range;
  bool largestOnly = false;                 ///< Keep the largest 26-connected part.
  double minMm3 = 0.0;                      ///< Drop 26-connected parts smaller than this.
  std::optional<ThresholdRange> only = {};  ///< Only voxels of these values change.
};

/// Sets `value` where the volume is in range (and cleared elsewhere where it was that value); other
/// labels stay, and win nothing: a voxel of another label inside the range is taken over.
/// Refuses a selection of no voxels, saying the volume's value range. Progress and cancel.
[[nodiscard]] Result<LabelGrid> segment(const Volume& volume, const LabelGrid* existing,
                                        std::uint8_t value, const SegmentRequest& request,
                                        const Progress& progress = {});

struct LabelCount {
  std::string name;
  std::uint8_t value = 0;
  std::size_t voxels = 0;
  double mm3 = 0.0;
};
/// How many voxels have each value.
[[nodiscard]] std::array<std::uint64_t, 256> countVoxels(const LabelGrid& labels);
[[nodiscard]] std::vector<LabelCount> countLabels(const LabelGrid& labels, const LabelTable& table);

}  // namespace palpate
