#include "imaging/segmentation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/short_number.h"
#include "imaging/components.h"
#include "imaging/otsu.h"

namespace palpate {
namespace {

using Colour = std::array<std::uint8_t, 3>;

std::string rangeText(double low, double high) {
  return shortNumber(low) + " to " + shortNumber(high);
}

template <class T>
void maskInRange(const std::vector<T>& values, const ThresholdRange& range, std::size_t from,
                 std::size_t to, std::vector<std::uint8_t>& mask) {
  for (std::size_t i = from; i < to; ++i) {
    const auto v = static_cast<double>(values[i]);
    mask[i] = v >= range.low && v <= range.high ? 1 : 0;
  }
}

Result<std::vector<std::uint8_t>> thresholdMask(const Volume& volume, const ThresholdRange& range,
                                                const Progress& progress) {
  std::vector<std::uint8_t> mask(volume.size());
  const auto slices = static_cast<std::size_t>(volume.geometry.dims[2]);
  const std::size_t slice = volume.size() / slices;
  for (std::size_t z = 0; z < slices; ++z) {
    if (progress.cancelled()) return fail(cancelled());
    if (volume.type == VoxelType::Int16) {
      maskInRange(volume.int16, range, z * slice, (z + 1) * slice, mask);
    } else {
      maskInRange(volume.float32, range, z * slice, (z + 1) * slice, mask);
    }
    progress(0.4 * static_cast<double>(z + 1) / static_cast<double>(slices), "Thresholding");
  }
  return mask;
}

/// Clears the parts that the request drops.
void keepParts(std::vector<std::uint8_t>& mask, const GridGeometry& geometry,
               const SegmentRequest& request) {
  const MaskParts parts = findParts(mask, geometry.dims);
  if (parts.voxels.empty()) return;
  const double mm3 = geometry.spacing.prod() * 1e9;
  const auto largest = static_cast<std::uint32_t>(
      std::max_element(parts.voxels.begin(), parts.voxels.end()) - parts.voxels.begin());
  std::vector<bool> dropped(parts.voxels.size());
  for (std::size_t part = 0; part < dropped.size(); ++part) {
    const bool tooSmall = static_cast<double>(parts.voxels[part]) * mm3 < request.minMm3;
    dropped[part] = tooSmall || (request.largestOnly && part != largest);
  }
  fillParts(parts, dropped, 0, geometry.dims[0], mask);
}

Error nothingSelected(const Volume& volume, const SegmentRequest& request, bool beforeParts) {
  if (!beforeParts) {
    return inputRefused("Every part in the range is smaller than the smallest part to keep.")
        .inField("min-mm3")
        .butFound(shortNumber(request.minMm3) + " mm3")
        .advise("Keep smaller parts.");
  }
  const auto [low, high] = valueRange(volume);
  return inputRefused("The threshold selects nothing.")
      .inField("threshold")
      .butFound(rangeText(request.range.low, request.range.high))
      .wants("a range that overlaps the volume's values, " + rangeText(low, high))
      .advise("Choose a range within the volume's values.");
}

Result<void> checkRequest(const Volume& volume, const LabelGrid* existing, std::uint8_t value,
                          const SegmentRequest& request) {
  if (value == 0) {
    return fail(usageError("Label 0 is the background.").wants("a label from 1 to 255"));
  }
  if (!(request.range.low <= request.range.high)) {
    return fail(usageError("The lower end of the threshold is above the upper end.")
                    .inField("threshold")
                    .butFound(rangeText(request.range.low, request.range.high))
                    .wants("low, then high")
                    .advise("Swap the two numbers."));
  }
  if (volume.size() == 0 || volume.size() != volume.geometry.voxelCount()) {
    return fail(inputRefused("The volume is empty."));
  }
  if (existing != nullptr && existing->labels.size() != volume.size()) {
    return fail(inputRefused("The labels do not have the volume's size.")
                    .butFound(std::to_string(existing->labels.size()) + " voxels")
                    .wants(std::to_string(volume.size()) + " voxels"));
  }
  return {};
}

/// The voxels in range that the request keeps, as ones. Refuses a selection of none.
Result<std::vector<std::uint8_t>> selectVoxels(const Volume& volume, const SegmentRequest& request,
                                               const Progress& progress) {
  auto mask = thresholdMask(volume, request.range, progress);
  if (!mask) return fail(mask.error());
  const auto any = [&mask] {
    return std::any_of(mask->begin(), mask->end(), [](std::uint8_t m) { return m != 0; });
  };
  if (!any()) return fail(nothingSelected(volume, request, true));
  if (request.largestOnly || request.minMm3 > 0.0) {
    progress(0.5, "Finding connected parts");
    keepParts(*mask, volume.geometry, request);
    if (!any()) return fail(nothingSelected(volume, request, false));
  }
  if (progress.cancelled()) return fail(cancelled());
  return mask;
}

}  // namespace

const std::vector<Preset>& segmentationPresets() {
  // HU ranges: bone from InVesalius (226, its default for an adult skull); soft tissue, skin and
  // air from the usual windows of radiology. 3071 is the largest HU of a 12-bit scanner. Air stops
  // above -1024 to leave out the padding that scanners write outside their circle.
  static const std::vector<Preset> presets{
      {"ct-bone", "Bone (CT)", "CT", "bone", Colour{227, 211, 177}, "bone",
       ThresholdRange{226, 3071}},
      {"ct-soft-tissue", "Soft tissue (CT)", "CT", "soft-tissue", Colour{201, 112, 100},
       "soft-tissue", ThresholdRange{-20, 225}},
      {"ct-skin", "Skin and all within (CT)", "CT", "skin", Colour{224, 172, 138}, "skin",
       ThresholdRange{-200, 3071}},
      {"ct-air", "Air (CT)", "CT", "air", Colour{120, 170, 210}, "air",
       ThresholdRange{-1023, -500}},
      {"mr-brain", "Brain (MR T1)", "MR", "brain", Colour{214, 170, 168}, "brain", std::nullopt},
      {"mr-tissue", "Tissue (MR)", "MR", "tissue", Colour{201, 140, 120}, "soft-tissue",
       std::nullopt},
  };
  return presets;
}

const Preset* presetNamed(const std::string& name) {
  for (const Preset& preset : segmentationPresets()) {
    if (preset.name == name) return &preset;
  }
  return nullptr;
}

const Preset* presetOfLabel(const std::string& label) {
  for (const Preset& preset : segmentationPresets()) {
    if (preset.label == label) return &preset;
  }
  return nullptr;
}

Result<ThresholdRange> presetRange(const std::string& preset, const Volume& volume) {
  const Preset* found = presetNamed(preset);
  if (found == nullptr) {
    std::string names;
    for (const Preset& p : segmentationPresets()) names += (names.empty() ? "" : ", ") + p.name;
    return fail(usageError("There is no such preset.")
                    .inField("preset")
                    .butFound(preset)
                    .wants(names)
                    .advise("Choose one of these, or give a threshold."));
  }
  if (found->range) return *found->range;
  const double top = valueRange(volume).second;
  if (preset == "mr-tissue") return ThresholdRange{otsuThreshold(volume), top};
  return ThresholdRange{otsuThresholds2(volume).second, top};
}

Result<LabelGrid> segment(const Volume& volume, const LabelGrid* existing, std::uint8_t value,
                          const SegmentRequest& request, const Progress& progress) {
  if (auto fits = checkRequest(volume, existing, value, request); !fits) return fail(fits.error());
  auto mask = selectVoxels(volume, request, progress);
  if (!mask) return fail(mask.error());
  LabelGrid out;
  out.geometry = volume.geometry;
  out.labels = std::move(*mask);
  const auto mayChange = [&](std::size_t i) {
    return !request.only ||
           (volume.value(i) >= request.only->low && volume.value(i) <= request.only->high);
  };
  for (std::size_t i = 0; i < out.labels.size(); ++i) {
    const std::uint8_t before = existing != nullptr ? existing->labels[i] : std::uint8_t{0};
    const std::uint8_t cleared = before == value ? std::uint8_t{0} : before;
    const std::uint8_t wanted = out.labels[i] != 0 ? value : cleared;
    out.labels[i] = mayChange(i) ? wanted : before;
  }
  progress(1.0, "Segmented");
  return out;
}

std::array<std::uint64_t, 256> countVoxels(const LabelGrid& labels) {
  // Runs of equal labels are the rule: one counter would wait for itself voxel after voxel.
  std::array<std::array<std::uint64_t, 256>, 4> partial{};
  for (std::size_t i = 0; i < labels.labels.size(); ++i) ++partial[i % 4][labels.labels[i]];
  std::array<std::uint64_t, 256> counts{};
  for (const auto& part : partial) {
    for (std::size_t value = 0; value < counts.size(); ++value) counts[value] += part[value];
  }
  return counts;
}

std::vector<LabelCount> countLabels(const LabelGrid& labels, const LabelTable& table) {
  const auto counts = countVoxels(labels);
  const double mm3 = labels.geometry.spacing.prod() * 1e9;
  std::vector<LabelCount> out;
  for (const LabelInfo& info : table) {
    const std::size_t n = counts[info.value];
    out.push_back({info.name, info.value, n, static_cast<double>(n) * mm3});
  }
  return out;
}

}  // namespace palpate
