#include "app/known_shape_scene.h"

#include <numbers>

#include "app/scene_loading.h"
#include "core/scene/material.h"

namespace palpate {
namespace {

/// +y of D, where the hand comes from, along z of W; its origin on the surface.
Eigen::Isometry3d deviceOver(KnownShape shape) {
  Eigen::Isometry3d X_WD = Eigen::Isometry3d::Identity();
  X_WD.linear() =
      Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX()).toRotationMatrix();
  X_WD.translation() = topOf(shape);
  return X_WD;
}

}  // namespace

Result<std::shared_ptr<const PreparedScene>> knownShapeScene(KnownShape shape, double spacing,
                                                             const std::filesystem::path& datasets,
                                                             const Progress& progress) {
  Scene scene = defaultScene();
  scene.name = nameOf(shape);
  scene.X_WD = deviceOver(shape);
  const auto instrument = instrumentNamed(scene.instrument, datasets);
  if (!instrument) return fail(instrument.error());
  const auto materials = readMaterials(datasets / "materials.toml");
  if (!materials) return fail(materials.error());
  auto labels = std::make_shared<const LabelGrid>(voxelsOf(shape, spacing));
  return prepareScene(scene, std::move(labels), {{"bone", 1, {227, 211, 177}, "bone"}}, *materials,
                      *instrument, progress);
}

}  // namespace palpate
