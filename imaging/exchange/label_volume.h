#pragma once
/// Labels as a MetaImage or NRRD volume; NRRD with the keys by which 3D Slicer names segments
/// (Segment0_Name, Segment0_Color, Segment0_LabelValue ...), so that a .seg.nrrd opens there as a
/// segmentation.

#include <filesystem>

#include "core/base/error.h"
#include "imaging/exchange/found_labels.h"

namespace palpate {

/// By extension, .mha or .nrrd; MetaImage has no names. Whole or not at all.
[[nodiscard]] Result<void> writeLabelVolume(const LabelGrid& labels, const LabelTable& table,
                                            const std::filesystem::path& file);
/// Values keep their numbers; those without a name in the file are "label-<value>". Outside a file
/// that covers a part of the volume all is background. Refused: what readLabelFile() and
/// fitToGrid() refuse; so also layers, in which 3D Slicer stores segments that overlap.
[[nodiscard]] Result<FoundLabels> readLabelVolume(const std::filesystem::path& file,
                                                  const GridGeometry& geometry);

}  // namespace palpate
