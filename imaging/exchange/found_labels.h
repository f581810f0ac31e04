#pragma once
/// What a file of another program holds: labels on a case's grid, with the names it gives them.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/voxels/label_grid.h"

namespace palpate {

/// At most as many characters as DICOM lets a segment's label have (PS3.5, "LO").
inline constexpr std::size_t kMaxLabelName = 64;

struct FoundLabel {
  std::string name;                                   ///< Not empty; unique in the file.
  std::uint8_t value = 0;                             ///< Of its voxels in `grid`; 1..255.
  std::optional<std::array<std::uint8_t, 3>> colour;  ///< sRGB, where the file says one.
};

/// `grid` has the geometry of the case's volume, bit for bit; labels without voxels are left out.
struct FoundLabels {
  LabelGrid grid;
  std::vector<FoundLabel> labels;  ///< Ascending by value.
  std::vector<std::string> warnings;
};

/// A name as the file has it, made fit for labels.toml: without control characters or blanks at
/// its ends, "label-<value>" where nothing is left. `changed` is set where it had to be cut.
[[nodiscard]] std::string labelName(const std::string& stated, int value, bool& changed);
/// Gives a second label of a name " (2)" and so on, and leaves out those that no voxel has; a
/// warning for each of the two.
void settleLabels(FoundLabels& found);

}  // namespace palpate
