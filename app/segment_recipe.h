#pragma once
/// What `segment` does to a case, as a list of steps: one from the command line, or several from a
/// recipe file.
///
///   [[step]]
///   preset = "ct-bone"          # or: threshold = [226, 3071]
///   label = "bone"              # default: the preset's; required with threshold
///   largest = true              # default false
///   min_mm3 = 10.0              # default 0
///
/// Steps run in order; a later one takes over what an earlier one claimed.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "imaging/segmentation.h"

namespace palpate {

struct SegmentStep {
  std::optional<std::string> preset;
  std::optional<ThresholdRange> threshold;  ///< Exactly one of the two.
  std::string label;                        ///< Empty: the preset's.
  bool largest = false;
  double minMm3 = 0.0;
};

/// Refuses unknown keys, wrong types, and a step without exactly one of preset and threshold, by
/// step and key.
[[nodiscard]] Result<std::vector<SegmentStep>> readSegmentRecipe(
    const std::filesystem::path& tomlFile);

}  // namespace palpate
