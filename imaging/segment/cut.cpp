/// Box and scissors: what is inside, or outside, is taken away.

#include <algorithm>
#include <cmath>

#include "imaging/segment/edit.h"

namespace palpate {
namespace {

/// Most corners of an outline: a hand draws hundreds.
constexpr std::size_t kMostCorners = 20000;

/// A closed outline, prepared for many points. Even-odd rule.
class Outline {
 public:
  explicit Outline(const std::vector<Eigen::Vector2d>& corners) : corners_(corners) {
    for (const Eigen::Vector2d& c : corners) {
      low_ = low_.cwiseMin(c);
      high_ = high_.cwiseMax(c);
    }
  }
  [[nodiscard]] bool contains(const Eigen::Vector2d& p) const {
    if ((p.array() < low_.array()).any() || (p.array() > high_.array()).any()) return false;
    bool inside = false;
    for (std::size_t i = 0, j = corners_.size() - 1; i < corners_.size(); j = i++) {
      const Eigen::Vector2d &a = corners_[i], &b = corners_[j];
      if ((a.y() > p.y()) == (b.y() > p.y())) continue;
      if (p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y())) inside = !inside;
    }
    return inside;
  }

 private:
  const std::vector<Eigen::Vector2d>& corners_;
  Eigen::Vector2d low_ = Eigen::Vector2d::Constant(1e300);
  Eigen::Vector2d high_ = Eigen::Vector2d::Constant(-1e300);
};

/// Clears the voxels of the label, or of all labels, that `goes(p_mm)` says.
template <class Goes>
void clear(const Edit& edit, bool allLabels, const Goes& goes) {
  const GridGeometry& g = edit.geometry();
  const VoxelBox box = allLabels ? wholeBox(g) : boundsOf(edit.labels, edit.value);
  forEachRow(g, box, [&](std::size_t first, std::int32_t count, std::int32_t y, std::int32_t z) {
    for (std::int32_t x = 0; x < count; ++x) {
      const std::size_t i = first + static_cast<std::size_t>(x);
      std::uint8_t& label = edit.labels.labels[i];
      if (label == 0 || (!allLabels && label != edit.value)) continue;
      if (!edit.mayChange(i)) continue;
      if (goes(Eigen::Vector3d(g.X_PV * g.centre_V(box.low[0] + x, y, z) * 1e3))) label = 0;
    }
  });
}

}  // namespace

Result<void> carryOut(Edit& edit, const tool::Box& tool) {
  if (!tool.low_mm.allFinite() || !tool.high_mm.allFinite() ||
      (tool.low_mm.array() > tool.high_mm.array()).any()) {
    return fail(usageError("The box's low corner is above its high corner.")
                    .inField("low")
                    .wants("low, then high, along each axis")
                    .advise("Swap the numbers."));
  }
  edit.share("Cutting").at(0.1);
  clear(edit, tool.allLabels, [&tool](const Eigen::Vector3d& p) {
    constexpr double kRounding_mm = 1e-6;  // a voxel on a face is in, whatever its last digit
    const bool inside = (p.array() >= tool.low_mm.array() - kRounding_mm).all() &&
                        (p.array() <= tool.high_mm.array() + kRounding_mm).all();
    return inside != tool.keepInside;
  });
  return {};
}

Result<void> carryOut(Edit& edit, const tool::Scissors& tool) {
  const bool finite = tool.view.allFinite() && tool.view.norm() > 0.0 &&
                      std::all_of(tool.outline.begin(), tool.outline.end(),
                                  [](const Eigen::Vector2d& c) { return c.allFinite(); }) &&
                      (!tool.plane_mm || tool.plane_mm->allFinite());
  if (!finite) return fail(usageError("The view or the outline has no numbers.").inField("view"));
  if (tool.outline.size() < 3 || tool.outline.size() > kMostCorners) {
    return fail(usageError("The outline is no area.")
                    .inField("outline")
                    .butFound(std::to_string(tool.outline.size()) + " corners")
                    .wants("3 to 20000 corners")
                    .advise("Draw around what is to go."));
  }
  if (auto fits = within(tool.depth_mm, 0.0, 1e6, "depth_mm"); !fits) return fits;
  edit.share("Cutting").at(0.1);
  const Outline outline(tool.outline);
  clear(edit, false, [&](const Eigen::Vector3d& p) {
    const Eigen::Vector4d h = p.homogeneous();
    if (tool.plane_mm && std::abs(tool.plane_mm->dot(h)) > tool.depth_mm) return false;
    const Eigen::Vector3d seen = tool.view * h;
    if (!(seen.z() > 0.0)) return false;
    return outline.contains(seen.head<2>() / seen.z()) != tool.keepInside;
  });
  return {};
}

}  // namespace palpate
