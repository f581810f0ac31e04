#pragma once
/// What a label is made of, as the contact response needs it (datasets/materials.toml).

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace palpate {

struct Material {
  std::string name;
  double stiffness_NPerMm = 2.0;  ///< For show and for soft contact; rigid contact ignores it.
  double friction = 0.2;          ///< Coulomb, with steel.
  double restitution = 0.0;       ///< 0..1
  double density_kgPerM3 = 1900.0;
  bool critical = false;  ///< Nerve, vessel, dura: to be kept away from.
  std::string source;     ///< Where the figures come from; one line.
};

/// Unknown keys and values out of range are refused by name.
[[nodiscard]] Result<std::vector<Material>> readMaterials(const std::filesystem::path& file);

}  // namespace palpate
