#pragma once
/// The open case in memory, and what the window says about it.

#include <array>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/base/progress.h"
#include "imaging/case_folder.h"
#include "imaging/segment/apply.h"
#include "imaging/segmentation.h"
#include "imaging/surface.h"
#include "ui/model.h"
#include "ui/workspace.h"

namespace palpate {

/// Labels and how many voxels each value has. States that differ in the table alone share their
/// voxels.
struct CountedLabels {
  std::shared_ptr<const LabelGrid> grid;  ///< Not null; without voxels where none are labelled.
  LabelTable table;
  std::array<std::uint64_t, 256> voxels{};

  [[nodiscard]] bool empty() const { return grid->labels.empty() || table.empty(); }
};
using SharedLabels = std::shared_ptr<const CountedLabels>;

/// Counts: a pass over all voxels.
[[nodiscard]] SharedLabels countedLabels(LabelState state);

/// Volume and labels are shared with jobs, never changed in place.
struct OpenCase {
  std::filesystem::path folder;
  CaseInfo info;
  std::shared_ptr<const Volume> volume;
  SharedLabels labels;  ///< Not null.
};

/// What the window says of a case and shows it with; found by passes over the whole volume.
struct CaseView {
  ui::CaseModel model;
  ui::VolumeLook look;
  std::vector<ThresholdRange> presetRanges;  ///< Of the presets of its modality.
};

/// Reads volume and labels; a case without labels is fine.
[[nodiscard]] Result<OpenCase> readCase(const std::filesystem::path& folder,
                                        const Progress& progress);
/// Any thread.
[[nodiscard]] CaseView viewOf(const OpenCase& open);
/// `bins` even bins over the value range, heights 0..1 on a logarithmic scale.
[[nodiscard]] std::vector<float> histogramOf(const Volume& volume, std::size_t bins);
[[nodiscard]] ui::CaseModel describeCase(const OpenCase& open);
[[nodiscard]] std::vector<ui::LabelRow> labelRows(const CountedLabels& labels);

/// The surface of every label of the table, its light from the grey values.
struct LabelSurface {
  std::uint8_t value = 0;
  ui::SharedChunks chunks;
};
[[nodiscard]] Result<std::vector<LabelSurface>> surfacesOf(const LabelGrid& labels,
                                                           const LabelTable& table,
                                                           const Volume& volume, int step,
                                                           const Progress& progress);

}  // namespace palpate
