#pragma once
/// Contacts as ray-sphere impostors: four vertices each, whatever the zoom.

#include <filesystem>

#include "core/simulation/snapshot.h"
#include "ui/camera.h"
#include "ui/gl_objects.h"

namespace palpate::ui {

class ContactImpostors {
 public:
  [[nodiscard]] static Result<ContactImpostors> load(const std::filesystem::path& shaders);
  /// Uploads positions (world = patient) minus `origin_mm`, colours by depth.
  void update(const Snapshot& snapshot, const Eigen::Vector3d& origin_mm);
  /// Into the bound framebuffer with depth. Contacts behind the anatomy or the instrument shine
  /// through.
  void draw(const Camera& camera, const Eigen::Vector3d& origin_mm, double aspect,
            double heightPixels) const;

 private:
  GlProgram program_;
  GlVertexArray array_;
  GlBuffer instances_;
  int count_ = 0;
};

}  // namespace palpate::ui
