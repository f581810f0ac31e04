#include "imaging/segment/apply.h"

#include <algorithm>
#include <set>

#include "imaging/segment/edit.h"
#include "imaging/segment/label_colours.h"

namespace palpate {
namespace {

/// Tools that can make a label out of nothing.
bool startsLabel(const LabelTool& tool) {
  if (const auto* brush = std::get_if<tool::Brush>(&tool)) return !brush->erase;
  if (const auto* combine = std::get_if<tool::Combine>(&tool)) {
    return combine->operation == tool::Combine::Operation::Add;
  }
  return std::holds_alternative<tool::Threshold>(tool) ||
         std::holds_alternative<tool::GrowRegion>(tool) ||
         std::holds_alternative<tool::Remove>(tool);
}

bool holds(const LabelGrid& labels, std::uint8_t value) {
  return std::find(labels.labels.begin(), labels.labels.end(), value) != labels.labels.end();
}

Result<void> checkGrids(const Volume& volume, const LabelGrid& before) {
  if (volume.size() == 0 || volume.size() != volume.geometry.voxelCount()) {
    return fail(inputRefused("The volume is empty."));
  }
  const std::size_t labels = before.labels.size();
  if (labels == 0 || labels == volume.size()) return {};
  return fail(inputRefused("The labels do not have the volume's size.")
                  .butFound(std::to_string(labels) + " voxels")
                  .wants(std::to_string(volume.size()) + " voxels"));
}

Error noSuchLabel(const std::string& label) {
  return inputRefused("There is no such label, or it is empty.")
      .inField("label")
      .butFound(label)
      .wants("a label of the case that has voxels")
      .advise("Make the label first, by a threshold or a brush.");
}

Error nothingLeft(const std::string& label) {
  return inputRefused("Nothing of the label would be left.")
      .inField("label")
      .butFound(label)
      .advise("Choose a milder setting, or remove the label.");
}

}  // namespace

std::string toolTitle(const LabelTool& tool) {
  static constexpr std::array<const char*, std::variant_size_v<LabelTool>> titles{
      "Threshold", "Grow region", "Islands", "Fill holes", "Margin",  "Smooth",
      "Box",       "Scissors",    "Brush",   "Split",      "Combine", "Remove"};
  return titles[tool.index()];
}

std::optional<std::uint8_t> lowestFreeValue(const LabelTable& table) {
  std::set<int> used;
  for (const LabelInfo& row : table) used.insert(row.value);
  for (int value = 1; value <= 255; ++value) {
    if (!used.contains(value)) return static_cast<std::uint8_t>(value);
  }
  return std::nullopt;
}

Result<LabelInfo> rowFor(const std::string& name, LabelTable& table) {
  if (name.empty()) return fail(usageError("The label has no name.").inField("label"));
  for (const LabelInfo& row : table) {
    if (row.name == name) return row;
  }
  const auto value = lowestFreeValue(table);
  if (!value) {
    return fail(inputRefused("The case has no room for another label.")
                    .inField("label")
                    .butFound("255 labels")
                    .wants("at most 255")
                    .advise("Use one of the labels that are there."));
  }
  LabelInfo row;
  row.name = name;
  row.value = *value;
  row.colour = labelColour(*value);
  if (const Preset* preset = presetOfLabel(name); preset != nullptr) {
    row.colour = preset->colour;
    if (!preset->material.empty()) row.material = preset->material;
  }
  table.push_back(row);
  return row;
}

Result<LabelState> applyStep(const Volume& volume, const LabelState& before, const LabelStep& step,
                             const Progress& progress) {
  return applyStep(volume, before.labels, before.table, step, progress);
}

Result<LabelState> applyStep(const Volume& volume, const LabelGrid& before, const LabelTable& table,
                             const LabelStep& step, const Progress& progress) {
  if (auto fits = checkGrids(volume, before); !fits) return fail(fits.error());
  if (step.limits.only) {
    if (auto fits = checkRange(*step.limits.only); !fits) {
      return fail(Error(fits.error()).inField("only"));
    }
  }
  if (progress.cancelled()) return fail(cancelled());
  LabelState after{{volume.geometry, before.labels}, table};
  after.labels.labels.resize(volume.size());
  const auto row = rowFor(step.label, after.table);
  if (!row) return fail(row.error());
  if (std::holds_alternative<tool::Remove>(step.tool)) {
    const bool there = std::any_of(table.begin(), table.end(),
                                   [&](const LabelInfo& l) { return l.name == step.label; });
    if (!there) return fail(noSuchLabel(step.label));
  }
  const bool starts = startsLabel(step.tool);
  if (!starts && !holds(after.labels, row->value)) {
    return fail(noSuchLabel(step.label));
  }
  LabelTool tool = step.tool;
  if (auto* threshold = std::get_if<tool::Threshold>(&tool); threshold != nullptr && step.preset) {
    const auto range = presetRange(*step.preset, volume);
    if (!range) return fail(range.error());
    threshold->range = *range;
  }
  Edit edit{volume, after.labels, after.table, row->value, step.limits, progress};
  const Result<void> done = std::visit([&edit](const auto& t) { return carryOut(edit, t); }, tool);
  if (!done) return fail(done.error());
  if (progress.cancelled()) return fail(cancelled());
  const bool mayEmpty = std::holds_alternative<tool::Remove>(tool);
  if (!mayEmpty && !holds(after.labels, row->value)) return fail(nothingLeft(step.label));
  progress(1.0, toolTitle(tool));
  return after;
}

}  // namespace palpate
