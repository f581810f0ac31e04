#include "ui/body_layer.h"

#include <algorithm>

#include "core/geometry/units.h"
#include "ui/gl_api.h"
#include "ui/surface_layer.h"

namespace palpate::ui {

void BodyLayer::setBodies(const std::vector<BodySurface>& bodies,
                          const Eigen::Vector3d& origin_mm) {
  bodies_.clear();
  for (const BodySurface& surface : bodies) {
    Body& body = bodies_.emplace_back();
    body.colour = Eigen::Vector3f(surface.colour[0], surface.colour[1], surface.colour[2]) / 255.0F;
    for (const SurfaceChunk& chunk : surface.chunks) {
      if (!chunk.triangles.empty()) body.chunks.push_back(meshOf(chunk, origin_mm));
    }
  }
}

void BodyLayer::draw(const GlProgram& program, const Snapshot& snapshot, const Camera& camera,
                     const Eigen::Vector3d& origin_mm, double aspect) const {
  if (bodies_.empty()) return;
  program.use();
  program.set("projection", camera.projection(aspect));
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    if (i < snapshot.bodies) X = isometry(snapshot.body[i]);
    // p_W = R p_B + t, both less the view's origin and in mm.
    Eigen::Isometry3d moved = X;
    moved.translation() = X.linear() * origin_mm + 1e3 * X.translation() - origin_mm;
    const Eigen::Matrix4f view = camera.view(origin_mm) * moved.matrix().cast<float>();
    program.set("modelView", view);
    program.set("normalMatrix", Eigen::Matrix3f(view.topLeftCorner<3, 3>()));
    program.set("baseColour", bodies_[i].colour);
    for (const GlMesh& chunk : bodies_[i].chunks) drawMesh(chunk);
  }
  glDisable(GL_DEPTH_TEST);
}

}  // namespace palpate::ui
