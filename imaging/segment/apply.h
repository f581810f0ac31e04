#pragma once
/// Carries out a tool on a case's labels.

#include <optional>
#include <string>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/voxels/label_grid.h"
#include "imaging/segment/tools.h"
#include "imaging/volume.h"

namespace palpate {

/// The labels after `step`. `before` may have no voxels (nothing labelled yet). A new label gets
/// the lowest free value, and colour and material of the preset of its name, else the next
/// Okabe–Ito colour and "bone".
///
/// Refuses (Usage) parameters out of range; (InputRefused) a label that is not there, a seed or
/// pick outside the scan, a pick with no part within 5 mm, a range that selects nothing or holds no
/// seed, and a step that would leave the label without a voxel. `before` is as it
/// was in all of these. Progress and cancel. Same input, same bits, whatever the threads. Any
/// thread; memory beside the volume and `before`: about two bytes a voxel, plus what a tool says.
[[nodiscard]] Result<LabelState> applyStep(const Volume& volume, const LabelState& before,
                                           const LabelStep& step, const Progress& progress = {});

[[nodiscard]] Result<LabelState> applyStep(const Volume& volume, const LabelGrid& before,
                                           const LabelTable& table, const LabelStep& step,
                                           const Progress& progress = {});

/// From 1 to 255; nothing where all are taken.
[[nodiscard]] std::optional<std::uint8_t> lowestFreeValue(const LabelTable& table);
/// The row of the label, added with the lowest free value where it is new.
[[nodiscard]] Result<LabelInfo> rowFor(const std::string& name, LabelTable& table);

}  // namespace palpate
