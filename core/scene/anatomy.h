#pragma once
/// What labels are usually called, look like and are made of (datasets/labels.toml).

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/voxels/label_grid.h"

namespace palpate {

struct Anatomy {
  std::string name;   ///< Of the label: "facial-nerve".
  std::string title;  ///< "Facial nerve"
  std::array<std::uint8_t, 3> colour{227, 211, 177};
  std::string material;  ///< A name in materials.toml.
};

/// Unknown keys, a name twice and values out of range are refused by name.
[[nodiscard]] Result<std::vector<Anatomy>> readAnatomies(const std::filesystem::path& file);

/// Their names, colours and materials as rows of a table; no row has a value.
[[nodiscard]] LabelTable rowsOfAnatomies(const std::vector<Anatomy>& anatomies);

/// Gives rows of `after` that are not in `before` the colour and material of the anatomy of their
/// name, where there is one.
void dressNewRows(const LabelTable& before, LabelTable& after,
                  const std::vector<Anatomy>& anatomies);

}  // namespace palpate
