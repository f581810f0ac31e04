#pragma once
/// The loose bodies in the 3D view: each one's surface, where the snapshot has it.

#include <array>
#include <vector>

#include "core/simulation/snapshot.h"
#include "imaging/surface.h"
#include "ui/camera.h"
#include "ui/gl_objects.h"

namespace palpate::ui {

/// The surface of a loose body where it starts (B is W there).
struct BodySurface {
  std::uint8_t label = 0;
  std::array<std::uint8_t, 3> colour{};  ///< sRGB
  std::vector<SurfaceChunk> chunks;
};

class BodyLayer {
 public:
  /// In the order of the scene's bodies. Vertices are stored minus `origin_mm`.
  void setBodies(const std::vector<BodySurface>& bodies, const Eigen::Vector3d& origin_mm);
  [[nodiscard]] bool empty() const noexcept { return bodies_.empty(); }
  /// Over the anatomy's picture and depth, with the program of mesh.vert + anatomy.frag.
  void draw(const GlProgram& program, const Snapshot& snapshot, const Camera& camera,
            const Eigen::Vector3d& origin_mm, double aspect) const;

 private:
  struct Body {
    std::vector<GlMesh> chunks;
    Eigen::Vector3f colour;
  };
  std::vector<Body> bodies_;
};

}  // namespace palpate::ui
