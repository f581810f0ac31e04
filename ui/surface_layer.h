#pragma once
/// The anatomy's surface in the 3D view: chunks of triangles, by label.

#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "imaging/surface.h"
#include "ui/gl_objects.h"
#include "ui/model.h"

namespace palpate::ui {

/// A chunk on the graphics card, its vertices minus `origin_mm`.
[[nodiscard]] GlMesh meshOf(const SurfaceChunk& chunk, const Eigen::Vector3d& origin_mm);

/// Of one label; not null.
using SharedChunks = std::shared_ptr<const std::vector<SurfaceChunk>>;

class SurfaceLayer {
 public:
  /// Replaces a label's chunks once send() has sent all of them. Vertices are stored minus
  /// `origin_mm`.
  void setLabel(std::uint8_t value, SharedChunks chunks, const Eigen::Vector3d& origin_mm);
  /// Sends what is not on the graphics card yet, a chunk at least, until then.
  void send(std::chrono::steady_clock::time_point until);
  [[nodiscard]] bool sending() const noexcept;
  void clear();
  /// Labels that are not in `rows` go.
  void keep(const std::vector<LabelRow>& rows);
  void setRows(const std::vector<LabelRow>& rows);
  /// These labels are drawn as loose bodies, not here.
  void setLoose(const std::vector<std::uint8_t>& values);
  /// With the program of mesh.vert + anatomy.frag in use and its matrices set.
  void draw(const GlProgram& program) const;

  /// Corners of the box around all surfaces, also those on their way, P, mm; nothing when empty.
  [[nodiscard]] std::optional<std::array<Eigen::Vector3d, 2>> bounds_mm() const;
  [[nodiscard]] bool empty() const noexcept { return labels_.empty(); }
  [[nodiscard]] std::size_t triangles() const noexcept;
  [[nodiscard]] std::uint64_t version() const noexcept { return version_; }

 private:
  struct Label {
    std::vector<GlMesh> chunks;                           ///< Drawn.
    std::vector<GlMesh> sent;                             ///< Of `coming`, so far.
    SharedChunks coming;                                  ///< Null: all is there.
    std::size_t next = 0;                                 ///< Of `coming`.
    Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();  ///< Of `coming`.
    Eigen::Vector3d low_mm = Eigen::Vector3d::Zero(), high_mm = Eigen::Vector3d::Zero();
    Eigen::Vector3f colour{0.89F, 0.83F, 0.69F};
    bool visible = true;
    bool loose = false;
    [[nodiscard]] bool empty() const noexcept { return low_mm.x() > high_mm.x(); }
  };
  std::map<std::uint8_t, Label> labels_;
  std::uint64_t version_ = 0;
};

}  // namespace palpate::ui
