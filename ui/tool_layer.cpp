#include "ui/tool_layer.h"

#include <algorithm>

#include "core/geometry/units.h"
#include "ui/arrow_shapes.h"
#include "ui/gl_api.h"
#include "ui/smooth_normals.h"

namespace palpate::ui {
namespace {

// Closer than this the ghost would only smear the instrument's edge.
constexpr double kGhostFrom_mm = 0.8;
constexpr double kLeastForce_N = 0.02;
constexpr double kLeastTorque_Nm = 1.5e-3;
constexpr double kLeastArc = 0.9;             // rad: shorter is no arc
constexpr double kArcPerTorque = 4.6 / 0.05;  // rad for a N·m: a full arc at 50 N·mm

Eigen::Vector3f rgb(const ImVec4& c) {
  return {c.x, c.y, c.z};
}

Eigen::Vector3d vec(const double (&v)[3]) {
  return {v[0], v[1], v[2]};
}

}  // namespace

Result<ToolLayer> ToolLayer::load(const std::filesystem::path& shaders) {
  ToolLayer self;
  const auto take = [&shaders](GlProgram& into, const char* fragment) -> Result<void> {
    auto program = GlProgram::load(shaders, "mesh.vert", fragment);
    if (!program) return fail(program.error());
    into = std::move(*program);
    return {};
  };
  if (auto ok = take(self.metal_, "metal.frag"); !ok) return fail(ok.error());
  if (auto ok = take(self.ghost_, "ghost.frag"); !ok) return fail(ok.error());
  if (auto ok = take(self.arrow_, "arrow.frag"); !ok) return fail(ok.error());
  return self;
}

void ToolLayer::setInstrument(const Instrument& instrument) {
  const DrawableMesh mesh = drawable(instrument.mesh_T, 0.7);
  mesh_ = makeMesh(mesh.interleaved, mesh.triangles);
  for (int c = 0; c < 3; ++c) {
    colour_[c] = static_cast<float>(instrument.colour[static_cast<std::size_t>(c)]) / 255.0F;
  }
}

void ToolLayer::clear() {
  mesh_ = GlMesh();
}

void ToolLayer::drawBody(const GlProgram& program, const Camera& camera,
                         const Eigen::Vector3d& origin_mm, const PlainPose& pose) const {
  Eigen::Matrix4f model = Eigen::Matrix4f::Identity();
  model.topLeftCorner<3, 3>() = orientation(pose).toRotationMatrix().cast<float>();
  model.topRightCorner<3, 1>() = (position(pose) * kMillimetresPerMetre - origin_mm).cast<float>();
  const Eigen::Matrix4f modelView = camera.view(origin_mm) * model;
  program.set("modelView", modelView);
  program.set("normalMatrix", Eigen::Matrix3f(modelView.topLeftCorner<3, 3>()));
  drawMesh(mesh_);
}

void ToolLayer::drawWrench(const Snapshot& snapshot, const Camera& camera,
                           const Eigen::Vector3d& origin_mm, double aspect, double heightPixels,
                           const Theme& theme) const {
  arrow_.use();
  arrow_.set("modelView", camera.view(origin_mm));
  arrow_.set("normalMatrix", Eigen::Matrix3f(camera.view(origin_mm).topLeftCorner<3, 3>()));
  arrow_.set("projection", camera.projection(aspect));
  arrow_.set("opacity", 0.95F);
  const double pixel = camera.millimetresPerPixel(heightPixels) * heightPixels / 700.0;
  const Eigen::Vector3d tip = position(snapshot.tool) * kMillimetresPerMetre - origin_mm;
  const auto show = [this](const DrawableMesh& shape, const ImVec4& colour) {
    arrow_.set("baseColour", rgb(colour));
    drawMesh(makeMesh(shape.interleaved, shape.triangles));
  };
  glDisable(GL_DEPTH_TEST);  // What the hand feels is never hidden; convex parts need no depth...
  glEnable(GL_CULL_FACE);    // ...once their backs are gone.
  const Eigen::Vector3d force = vec(snapshot.felt.force);
  if (force.norm() > kLeastForce_N) {
    const double length = std::min(kLongestArrow_mm, kArrow_mmPerN * force.norm());
    show(arrowShape(tip, force.normalized(), length, 2.4 * pixel), theme.accent);
  }
  // The contact's torque about the tip: most devices draw it because they cannot make it felt.
  const Eigen::Vector3d torque = vec(snapshot.contact.torque);
  if (torque.norm() > kLeastTorque_Nm) {
    show(arcShape(tip, torque.normalized(), 30.0 * pixel, kLeastArc + torque.norm() * kArcPerTorque,
                  1.8 * pixel),
         theme.attention);
  }
  glDisable(GL_CULL_FACE);
}

void ToolLayer::draw(const Snapshot& snapshot, const Camera& camera,
                     const Eigen::Vector3d& origin_mm, double aspect, double heightPixels,
                     const Theme& theme) const {
  if (!loaded()) return;
  const Eigen::Matrix4f projection = camera.projection(aspect);
  glEnable(GL_DEPTH_TEST);
  metal_.use();
  metal_.set("projection", projection);
  metal_.set("baseColour", colour_);
  drawBody(metal_, camera, origin_mm, snapshot.tool);

  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  ghost_.use();
  ghost_.set("projection", projection);
  // Where anatomy hides the instrument, its outline shines through.
  glDepthFunc(GL_GREATER);
  ghost_.set("baseColour", rgb(theme.accent));
  ghost_.set("opacity", 0.16F);
  drawBody(ghost_, camera, origin_mm, snapshot.tool);
  glDepthFunc(GL_LESS);
  const double apart_mm =
      (position(snapshot.tool) - position(snapshot.device)).norm() * kMillimetresPerMetre;
  if (apart_mm > kGhostFrom_mm) {
    ghost_.set("opacity", static_cast<float>(std::min(0.75, 0.25 + 0.08 * apart_mm)));
    drawBody(ghost_, camera, origin_mm, snapshot.device);
  }
  glDepthMask(GL_TRUE);
  drawWrench(snapshot, camera, origin_mm, aspect, heightPixels, theme);
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
}

}  // namespace palpate::ui
