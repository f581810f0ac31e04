#include <algorithm>
#include <optional>

#include "imaging/exchange/label_exchange.h"
#include "imaging/exchange/label_volume.h"
#include "imaging/exchange/seg_read.h"
#include "imaging/exchange/surface_read.h"
#include "imaging/exchange/surface_voxels.h"
#include "imaging/segment/apply.h"
#include "imaging/segment/label_colours.h"
#include "imaging/segmentation.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

using Colour = std::array<std::uint8_t, 3>;

Result<FoundLabels> readSurfaceLabel(const fs::path& file, ExchangeFormat format,
                                     const GridGeometry& geometry, const Progress& progress) {
  const auto mesh = readSurface(file, format);
  if (!mesh) return fail(mesh.error());
  auto inside = voxelsInside(*mesh, geometry, file, progress);
  if (!inside) return fail(inside.error());
  FoundLabels found;
  found.grid.geometry = geometry;
  found.grid.labels = std::move(inside->mask);
  found.labels.push_back({"label-1", 1, std::nullopt});
  if (inside->reachesOut) {
    found.warnings.emplace_back("The surface reaches out of the volume and is cut there.");
  }
  return found;
}

Result<FoundLabels> read(const fs::path& file, const GridGeometry& geometry,
                         const Progress& progress) {
  const auto format = importFormat(file);
  if (!format) return fail(format.error());
  if (isSurface(*format)) return readSurfaceLabel(file, *format, geometry, progress);
  if (*format == ExchangeFormat::DicomSeg) return readDicomSeg(file, geometry, progress);
  return readLabelVolume(file, geometry);
}

Result<void> choose(FoundLabels& found, const std::string& only, const fs::path& file) {
  if (only.empty()) return {};
  if (found.labels.size() == 1) {
    found.labels.front().name = only;
    return {};
  }
  std::string names;
  for (const FoundLabel& label : found.labels) names += (names.empty() ? "" : ", ") + label.name;
  std::erase_if(found.labels, [&](const FoundLabel& label) { return label.name != only; });
  if (!found.labels.empty()) return {};
  return fail(
      inputRefused("The file has no label of that name.")
          .inFile(file.string())
          .inField("--label")
          .butFound(only)
          .wants("one of " + names)
          .advise("Choose one of these, or none to take them all; `palpate segment` without "
                  "--label does."));
}

/// The stated value where no row has it, else the lowest free one.
std::optional<std::uint8_t> freeValue(const LabelTable& table, std::uint8_t stated) {
  const bool taken = std::any_of(table.begin(), table.end(),
                                 [stated](const LabelInfo& row) { return row.value == stated; });
  return taken ? lowestFreeValue(table) : stated;
}

/// The label's row in the table, made where there is none. False where the table is full.
bool addRow(const FoundLabel& label, const LabelTable& usual, LabelTable& table,
            std::vector<std::string>& guessed) {
  const auto value = freeValue(table, label.value);
  if (!value) return false;
  const Preset* preset = presetOfLabel(label.name);
  LabelInfo row;
  row.name = label.name;
  row.value = *value;
  row.colour = label.colour.value_or(preset != nullptr ? preset->colour : labelColour(*value));
  row.material = preset != nullptr ? preset->material : "bone";
  const auto known = std::find_if(usual.begin(), usual.end(),
                                  [&label](const LabelInfo& l) { return l.name == label.name; });
  if (known != usual.end()) {
    row.material = known->material;
    if (!label.colour) row.colour = known->colour;
  } else if (preset == nullptr) {
    guessed.push_back(label.name);
  }
  table.push_back(row);
  return true;
}

std::string guessWarning(const std::vector<std::string>& guessed) {
  std::string names;
  for (const std::string& name : guessed) names += (names.empty() ? "" : ", ") + name;
  return "The material of " + names +
         " is a guess (bone): choose the right one in the window, or in "
         "labels.toml.";
}

}  // namespace

Result<FoundLabels> importLabels(const fs::path& file, const GridGeometry& geometry,
                                 const std::string& only, const Progress& progress) {
  auto found = read(file, geometry, progress);
  if (!found) return found;
  if (found->labels.empty()) {
    return fail(inputRefused("The file holds no labels.")
                    .inFile(file.string())
                    .wants("voxels other than background")
                    .advise("Choose the file that holds the segmentation."));
  }
  if (auto chosen = choose(*found, only, file); !chosen) return fail(chosen.error());
  return found;
}

Result<void> mergeLabels(const FoundLabels& found, LabelGrid& labels, LabelTable& table,
                         std::vector<std::string>& warnings, const LabelTable& usual) {
  std::array<std::uint8_t, 256> becomes{};
  std::array<bool, 256> replaced{};
  std::vector<std::string> guessed;
  for (const FoundLabel& label : found.labels) {
    const auto named = [&label](const LabelInfo& row) { return row.name == label.name; };
    auto row = std::find_if(table.begin(), table.end(), named);
    if (row == table.end()) {
      if (!addRow(label, usual, table, guessed)) {
        return fail(inputRefused("The case has no room for another label.")
                        .inField("label")
                        .butFound("255 labels")
                        .wants("at most 255")
                        .advise("Choose one label of the file; `palpate segment --label NAME` "
                                "does."));
      }
      row = table.end() - 1;
    }
    becomes[label.value] = row->value;
    replaced[row->value] = true;
  }
  for (std::size_t i = 0; i < labels.labels.size(); ++i) {
    const std::uint8_t now = becomes[found.grid.labels[i]];
    std::uint8_t& label = labels.labels[i];
    if (now != 0) {
      label = now;
    } else if (replaced[label]) {
      label = 0;
    }
  }
  if (!guessed.empty()) warnings.push_back(guessWarning(guessed));
  return {};
}

Result<JoinedLabels> joinLabels(const fs::path& file, const GridGeometry& geometry,
                                const std::string& only, LabelState before, const LabelTable& usual,
                                const Progress& progress) {
  auto found = importLabels(file, geometry, only, progress);
  if (!found) return fail(found.error());
  JoinedLabels joined;
  for (const FoundLabel& label : found->labels) {
    const bool there =
        std::any_of(before.table.begin(), before.table.end(),
                    [&label](const LabelInfo& row) { return row.name == label.name; });
    (there ? joined.replaced : joined.added).push_back(label.name);
  }
  joined.state = std::move(before);
  if (joined.state.labels.labels.empty()) {
    joined.state.labels.geometry = geometry;
    joined.state.labels.labels.assign(geometry.voxelCount(), 0);
  }
  joined.warnings = std::move(found->warnings);
  if (auto merged =
          mergeLabels(*found, joined.state.labels, joined.state.table, joined.warnings, usual);
      !merged) {
    return fail(merged.error());
  }
  if (progress.cancelled()) return fail(cancelled());
  return joined;
}

}  // namespace palpate
