#pragma once
/// What a label is made of, as the contact response needs it (datasets/materials.toml).

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace palpate {

/// How a material meets another one, where it was looked up or measured.
struct MaterialPair {
  std::string other;         ///< A name in the file, or kSteel.
  double friction = 0.2;     ///< Coulomb, >= 0.
  double restitution = 0.0;  ///< 0..1
};

/// What instruments are made of unless they say otherwise: `friction` and `restitution` of every
/// material are those with wet steel.
inline constexpr const char* kSteel = "steel";

struct Material {
  std::string name;
  double stiffness_NPerMm = 2.0;  ///< For show and for soft contact; rigid contact ignores it.
  double friction = 0.2;          ///< Coulomb, with steel.
  double restitution = 0.0;       ///< 0..1
  double density_kgPerM3 = 1900.0;
  bool critical = false;           ///< Nerve, vessel, dura: to be kept away from.
  std::string source;              ///< Where the figures come from; one line.
  std::vector<MaterialPair> with;  ///< [[material.with]]
};

/// What contact of two materials is like; the order does not matter. A pair that either names; else
/// with steel the other's own; else a rule of thumb, not a measurement: the geometric mean of their
/// frictions with steel, the lower restitution. A name that is not among the materials is steel.
[[nodiscard]] MaterialPair pairOf(const std::vector<Material>& materials, const std::string& a,
                                  const std::string& b);

/// Unknown keys and values out of range are refused by name.
[[nodiscard]] Result<std::vector<Material>> readMaterials(const std::filesystem::path& file);

}  // namespace palpate
