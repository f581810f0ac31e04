#pragma once
/// The open case in memory, and what the window says about it.

#include <filesystem>
#include <memory>
#include <vector>

#include "core/base/progress.h"
#include "imaging/case_folder.h"
#include "imaging/segment/apply.h"
#include "imaging/surface.h"
#include "ui/model.h"

namespace palpate {

/// Volume and labels are shared with jobs, never changed in place.
struct OpenCase {
  std::filesystem::path folder;
  CaseInfo info;
  std::shared_ptr<const Volume> volume;
  std::shared_ptr<const LabelGrid> labels;  ///< Null: none yet.
  LabelTable table;
};

/// Reads volume and labels; a case without labels is fine.
[[nodiscard]] Result<OpenCase> readCase(const std::filesystem::path& folder,
                                        const Progress& progress);
/// `bins` even bins over the value range, heights 0..1 on a logarithmic scale.
[[nodiscard]] std::vector<float> histogramOf(const Volume& volume, std::size_t bins);
[[nodiscard]] ui::CaseModel describeCase(const OpenCase& open);
[[nodiscard]] std::vector<ui::LabelRow> labelRows(const LabelState& state);

/// The surface of every label of the table, its light from the grey values.
struct LabelSurface {
  std::uint8_t value = 0;
  std::vector<SurfaceChunk> chunks;
};
[[nodiscard]] Result<std::vector<LabelSurface>> surfacesOf(const LabelGrid& labels,
                                                           const LabelTable& table,
                                                           const Volume& volume, int step,
                                                           const Progress& progress);

}  // namespace palpate
