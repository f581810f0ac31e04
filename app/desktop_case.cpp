#include "app/desktop_case.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/units.h"
#include "ui/format.h"
#include "ui/grey_normals.h"

namespace palpate {

SharedLabels countedLabels(LabelState state) {
  CountedLabels counted;
  counted.voxels = countVoxels(state.labels);
  counted.grid = std::make_shared<const LabelGrid>(std::move(state.labels));
  counted.table = std::move(state.table);
  return std::make_shared<const CountedLabels>(std::move(counted));
}

Result<OpenCase> readCase(const std::filesystem::path& folder, const Progress& progress) {
  OpenCase open;
  open.folder = folder;
  progress(0.0, "Reading the case");
  auto info = readCaseInfo(folder);
  if (!info) return fail(info.error());
  open.info = std::move(*info);
  open.labels = countedLabels({});
  progress(0.1, "Reading the volume");
  auto volume = readCaseVolume(folder);
  if (!volume) return fail(volume.error());
  if (volume->modality.empty()) volume->modality = open.info.modality;
  open.volume = std::make_shared<const Volume>(std::move(*volume));
  if (progress.cancelled()) return fail(cancelled());
  if (caseHasLabels(folder)) {
    progress(0.7, "Reading the labels");
    auto state = readCaseLabelState(folder);
    if (!state) return fail(state.error());
    if (state->labels.geometry.dims != open.volume->geometry.dims) {
      return fail(inputRefused("The labels of this case do not fit its volume.")
                      .inFile((folder / "labels.mha").string())
                      .advise("Remove labels.mha and segment again."));
    }
    open.labels = countedLabels(std::move(*state));
  }
  progress(1.0, "Read");
  return open;
}

std::vector<float> histogramOf(const Volume& volume, std::size_t bins) {
  const auto [low, high] = valueRange(volume);
  std::vector<double> count(bins, 0.0);
  const double span = std::max(1e-9, high - low);
  for (std::size_t i = 0; i < volume.size(); ++i) {
    const double f = (volume.value(i) - low) / span * static_cast<double>(bins);
    const auto bin = static_cast<std::size_t>(std::max(0.0, f));
    count[std::min(bins - 1, bin)] += 1.0;
  }
  // Air would dwarf everything on a linear scale.
  const double most = std::log1p(*std::max_element(count.begin(), count.end()));
  std::vector<float> heights;
  for (const double c : count)
    heights.push_back(static_cast<float>(std::log1p(c) / std::max(1e-9, most)));
  return heights;
}

ui::CaseModel describeCase(const OpenCase& open) {
  ui::CaseModel model;
  model.open = true;
  model.folder = open.folder;
  model.title = open.info.pseudonym.empty() ? open.folder.filename().string() : open.info.pseudonym;
  if (!open.info.description.empty()) model.title = open.info.description;
  model.modality = open.volume->modality;
  model.fileName = open.info.pseudonym.empty() ? "case" : open.info.pseudonym;
  const GridGeometry& g = open.volume->geometry;
  model.geometry = ui::spacingText(millimetres(g.spacing.x()), millimetres(g.spacing.y()),
                                   millimetres(g.spacing.z()));
  model.source = open.info.sourceFormat + ", " + std::to_string(g.dims[0]) + " \xc3\x97 " +
                 std::to_string(g.dims[1]) + " \xc3\x97 " + std::to_string(g.dims[2]);
  model.warnings = open.info.warnings;
  model.repairs = open.info.repairs;
  model.lossy = open.info.lossy;
  const auto [low, high] = valueRange(*open.volume);
  model.valueRange = {low, high};
  model.presetModality = !model.modality.empty() ? model.modality : low < -500.0 ? "CT" : "MR";
  model.histogram = histogramOf(*open.volume, 128);
  return model;
}

CaseView viewOf(const OpenCase& open) {
  CaseView view;
  view.model = describeCase(open);
  view.look = ui::lookOf(*open.volume);
  for (const Preset& preset : segmentationPresets()) {
    if (preset.modality != view.model.presetModality) continue;
    const auto range = presetRange(preset.name, *open.volume);
    view.presetRanges.push_back(range ? *range : ThresholdRange{});
  }
  return view;
}

std::vector<ui::LabelRow> labelRows(const CountedLabels& labels) {
  std::vector<ui::LabelRow> rows;
  const double mm3 = labels.grid->geometry.spacing.prod() * 1e9;
  for (const LabelInfo& label : labels.table) {
    const std::uint64_t voxels = labels.voxels[label.value];
    rows.push_back({label.name, label.value, label.colour, voxels,
                    static_cast<double>(voxels) * mm3, true, label.material});
  }
  return rows;
}

Result<std::vector<LabelSurface>> surfacesOf(const LabelGrid& labels, const LabelTable& table,
                                             const Volume& volume, int step,
                                             const Progress& progress) {
  std::vector<LabelSurface> surfaces;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double base = static_cast<double>(i) / static_cast<double>(table.size());
    Progress part;
    part.cancel = progress.cancel;
    part.report = [&](double f, const std::string&) {
      progress(base + f / static_cast<double>(table.size()), "Surface of " + table[i].name);
    };
    auto chunks = meshLabel(labels, table[i].value, step, part);
    if (!chunks) return fail(chunks.error());
    ui::shadeByGrey(*chunks, volume);
    surfaces.push_back(
        {table[i].value, std::make_shared<const std::vector<SurfaceChunk>>(std::move(*chunks))});
  }
  return surfaces;
}

}  // namespace palpate
