#pragma once
/// The camera of the 3D view: orbits a target in P, millimetres, perspective.

#include <Eigen/Geometry>

namespace palpate::ui {

struct Camera {
  Eigen::Vector3d target_mm = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_PC =
      Eigen::Quaterniond::Identity();  ///< C: +x right, +y up, looks along -z.
  double distance_mm = 500.0;
  double fieldOfView = 0.5236;  ///< Vertical, rad (30°: little distortion).

  /// Looks at a box from the patient's front, left and slightly above, all of it in view.
  void frame(const Eigen::Vector3d& low_mm, const Eigen::Vector3d& high_mm, double aspect);
  /// Looks from `from_P` (towards the target), the patient's head up.
  void lookFrom(const Eigen::Vector3d& from_P);

  void orbit(double dx, double dy);  ///< Radians of turn about the view's up and right.
  void pan(double dxPixels, double dyPixels, double viewHeight);
  void zoom(double steps);  ///< Positive comes nearer; one step is 10 %.

  [[nodiscard]] Eigen::Vector3d eye_mm() const;
  /// Millimetres across one pixel at the target's depth.
  [[nodiscard]] double millimetresPerPixel(double viewHeight) const;
  /// From P (mm) minus `origin_mm` to the camera: small numbers, so that float is enough.
  [[nodiscard]] Eigen::Matrix4f view(const Eigen::Vector3d& origin_mm) const;
  [[nodiscard]] Eigen::Matrix4f projection(double aspect) const;
  [[nodiscard]] double nearPlane() const { return distance_mm * 0.05; }
  [[nodiscard]] double farPlane() const { return distance_mm * 4.0 + 600.0; }
  [[nodiscard]] bool operator==(const Camera& other) const;
};

}  // namespace palpate::ui
