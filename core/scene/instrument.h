#pragma once
/// An instrument: a closed mesh drawn from a few numbers, its mass, and its point shell.
///
/// Frame T: origin at the working tip, +z along the shaft away from the tip (towards the hand), so
/// that T coincides with a Phantom's stylus frame. A file in datasets/instruments holds elliptical
/// cross-sections along a path, the mesh is swept through them.

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/collision/point_shell.h"
#include "core/dynamics/mass_properties.h"
#include "core/geometry/triangle_mesh.h"
#include "core/scene/material.h"

namespace palpate {

struct Instrument {
  std::string name;   ///< File stem: "ball-burr".
  std::string title;  ///< "Ball burr, 6 mm".
  std::string description;
  std::string source;             ///< Who drew it, and its licence.
  std::string material = kSteel;  ///< A name in materials.toml, or kSteel.
  TriangleMesh mesh_T;
  MassProperties massProperties;
  std::array<std::uint8_t, 3> colour{190, 196, 204};
  double shellSpacing = 0.5e-3;  ///< m; the file's default, a scene may change it.
};

[[nodiscard]] Result<Instrument> readInstrument(const std::filesystem::path& tomlFile);
/// Every instrument of a folder, by name; unreadable ones are errors.
[[nodiscard]] Result<std::vector<Instrument>> readInstruments(const std::filesystem::path& folder);

}  // namespace palpate
