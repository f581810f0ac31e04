#pragma once
/// What settings are judged against: the anatomy as a signed distance, in double precision.
///
/// Shares no code with core/voxels or core/collision, so that a fault there shows as an error.

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/voxels/label_grid.h"

namespace palpate {

/// World frame W, metres. Any thread, several at once.
class ReferenceShape {
 public:
  virtual ~ReferenceShape() = default;
  /// m: above 0 outside, below 0 inside; +infinity where nothing is defined.
  [[nodiscard]] virtual double distance(const Eigen::Vector3d& p_W) const = 0;
  /// m: how far a point can move at least before distance() falls below `margin`; 0 is always
  /// right.
  [[nodiscard]] virtual double clearance(const Eigen::Vector3d& p_W, double margin) const = 0;
  /// Outward unit normal at a point where distance() is finite.
  [[nodiscard]] virtual Eigen::Vector3d normal(const Eigen::Vector3d& p_W) const = 0;
};

/// Anatomy in closed form, about the origin of W: its surface meets +z (but for the torus, whose
/// axis is z) at the height that a hand reaches first.
enum class KnownShape : std::uint8_t {
  Sphere,    ///< Radius 24 mm.
  Plane,     ///< Everything below z = 0.
  Cylinder,  ///< Axis x, radius 20 mm, endless.
  Wedge,     ///< A ridge of 90 degrees along x, its edge at z = 0.
  Torus      ///< Axis z, ring 18 mm, tube 9 mm.
};

/// "sphere", "plane", "cylinder", "wedge", "torus".
[[nodiscard]] Result<KnownShape> knownShapeNamed(const std::string& name);
[[nodiscard]] const char* nameOf(KnownShape shape) noexcept;
[[nodiscard]] std::unique_ptr<ReferenceShape> closedForm(KnownShape shape);

/// The place of its surface that a hand above reaches first, m.
[[nodiscard]] Eigen::Vector3d topOf(KnownShape shape) noexcept;

/// The shape as voxels: a cube of 64 mm about the origin; a voxel belongs to it when its centre
/// does. @param spacing  m.
[[nodiscard]] LabelGrid voxelsOf(KnownShape shape, double spacing);

}  // namespace palpate
