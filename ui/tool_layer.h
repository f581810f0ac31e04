#pragma once
/// The instrument, the ghost of the device, and what the hand feels: force arrow and torque arc.

#include <filesystem>

#include "core/scene/instrument.h"
#include "core/simulation/snapshot.h"
#include "ui/camera.h"
#include "ui/gl_objects.h"
#include "ui/theme.h"

namespace palpate::ui {

class ToolLayer {
 public:
  [[nodiscard]] static Result<ToolLayer> load(const std::filesystem::path& shaders);
  void setInstrument(const Instrument& instrument);
  void clear();
  [[nodiscard]] bool loaded() const noexcept { return mesh_.indexCount > 0; }

  /// Into the bound framebuffer, over the anatomy's depth.
  void draw(const Snapshot& snapshot, const Camera& camera, const Eigen::Vector3d& origin_mm,
            double aspect, double heightPixels, const Theme& theme) const;

 private:
  void drawBody(const GlProgram& program, const Camera& camera, const Eigen::Vector3d& origin_mm,
                const PlainPose& pose) const;
  void drawWrench(const Snapshot& snapshot, const Camera& camera, const Eigen::Vector3d& origin_mm,
                  double aspect, double heightPixels, const Theme& theme) const;
  GlProgram metal_, ghost_, arrow_;
  GlMesh mesh_;
  Eigen::Vector3f colour_{0.75F, 0.77F, 0.8F};
};

}  // namespace palpate::ui
