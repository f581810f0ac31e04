/// tool::Scissors against points in polygons, one voxel after the other.

#include <algorithm>
#include <cmath>

#include "tests/imaging/segment/samples.h"

namespace palpate::test {
namespace {

/// How often a line from p crosses the outline, towards +u or -u; and how near the outline is.
struct Crossings {
  int right = 0, left = 0;
  double nearest = 1e300;
};

Crossings crossings(const Eigen::Vector2d& p, const std::vector<Eigen::Vector2d>& outline) {
  Crossings out;
  for (std::size_t n = 0; n < outline.size(); ++n) {
    const Eigen::Vector2d& a = outline[n];
    const Eigen::Vector2d& b = outline[(n + 1) % outline.size()];
    const Eigen::Vector2d along = b - a;
    const double length = std::max(along.squaredNorm(), 1e-300);
    const double t = std::clamp((p - a).dot(along) / length, 0.0, 1.0);
    out.nearest = std::min(out.nearest, (p - a - t * along).norm());
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    const double u = a.x() + along.x() * (p.y() - a.y()) / along.y();
    ++(u > p.x() ? out.right : out.left);
  }
  return out;
}

struct Camera {
  Eigen::Matrix<double, 3, 4> view;
  double unit = 1.0;  ///< Millimetres of P that are one unit of (u, v), about.
};

Camera orthographic(Random& random) {
  Camera camera;
  const Eigen::Matrix3d axes =
      Eigen::AngleAxisd(random.real(-3, 3), random.point(-1, 1).normalized()).toRotationMatrix();
  camera.view.setZero();
  camera.unit = random.chance(50) ? 1.0 : 150.0;
  camera.view.block<2, 3>(0, 0) = axes.topRows<2>() / camera.unit;
  camera.view(0, 3) = random.real(-0.1, 0.1);
  camera.view(1, 3) = random.real(-0.1, 0.1);
  camera.view(2, 3) = random.chance(50) ? 1.0 : 0.5;
  camera.view.topRows<2>() *= camera.view(2, 3);
  return camera;
}

/// The eye near or in the scan, so that some of it lies behind.
Camera perspective(Random& random, const Sample& s) {
  Camera camera;
  const Eigen::Matrix3d axes =
      Eigen::AngleAxisd(random.real(-3, 3), random.point(-1, 1).normalized()).toRotationMatrix();
  const auto middle = static_cast<std::size_t>(random.whole(0, static_cast<int>(s.size()) - 1));
  const Eigen::Vector3d eye =
      centre_mm(s.geometry(), middle) - axes.row(2).transpose() * random.real(-2.0, 20.0);
  const double zoom = random.real(0.5, 3.0);
  camera.view.block<3, 3>(0, 0) = axes;
  camera.view.col(3) = -(axes * eye);
  camera.view.topRows<2>() *= zoom;
  camera.unit = 0.0;
  return camera;
}

/// (u, v) of a centre; nothing behind the eye. `sure` is false where the plane of the eye decides.
std::optional<Eigen::Vector2d> seen(const Camera& camera, const Eigen::Vector3d& p, bool& sure) {
  const Eigen::Vector3d image = camera.view * p.homogeneous();
  sure = std::abs(image.z()) > 1e-7;
  if (image.z() <= 0.0) return std::nullopt;
  return Eigen::Vector2d(image.x() / image.z(), image.y() / image.z());
}

/// Points around where the scan is seen: three corners to nine, mostly crossing themselves.
std::vector<Eigen::Vector2d> randomOutline(Random& random, const Sample& s, const Camera& camera) {
  Eigen::Vector2d low(1e300, 1e300);
  Eigen::Vector2d high(-1e300, -1e300);
  for (std::size_t i = 0; i < s.size(); ++i) {
    bool sure = false;
    const auto uv = seen(camera, centre_mm(s.geometry(), i), sure);
    if (!uv || uv->norm() > 50.0 * std::max(1.0, 150.0 / std::max(camera.unit, 1.0))) continue;
    low = low.cwiseMin(*uv);
    high = high.cwiseMax(*uv);
  }
  if (low.x() > high.x()) low = high = Eigen::Vector2d::Zero();
  const Eigen::Vector2d room =
      0.2 * (high - low) + Eigen::Vector2d::Constant(0.5 / std::max(1.0, camera.unit));
  std::vector<Eigen::Vector2d> outline;
  for (int n = random.whole(3, 9); n > 0; --n) {
    const double u = random.real(low.x() - room.x(), high.x() + room.x());
    outline.emplace_back(u, random.real(low.y() - room.y(), high.y() + room.y()));
  }
  return outline;
}

void compare(Random& random, Sample& s, const Camera& camera) {
  tool::Scissors tool;
  tool.view = camera.view;
  tool.outline = randomOutline(random, s, camera);
  tool.keepInside = random.chance(50);
  if (random.chance(40)) {
    const auto at = static_cast<std::size_t>(random.whole(0, static_cast<int>(s.size()) - 1));
    const Eigen::Vector3d normal = random.point(-1, 1).normalized();
    Eigen::Vector4d plane;
    plane << normal, -normal.dot(somewhereIn_mm(random, s.geometry(), at));
    tool.plane_mm = plane;
    tool.depth_mm = random.real(0.2, 4.0);
  }
  Mask wanted = s.label();
  Mask either(s.size(), 0);
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Eigen::Vector3d p = centre_mm(s.geometry(), i);
    bool sure = false;
    const auto uv = seen(camera, p, sure);
    if (!sure) either[i] = wanted[i];
    if (!uv) continue;
    if (tool.plane_mm && std::abs(tool.plane_mm->dot(p.homogeneous())) > tool.depth_mm) continue;
    const Crossings found = crossings(*uv, tool.outline);
    if (found.nearest < 1e-9 * (1.0 + uv->norm())) either[i] = wanted[i];
    ASSERT_EQ(found.left % 2, found.right % 2) << "the oracle itself";
    if ((found.right % 2 == 1) != tool.keepInside) wanted[i] = 0;
  }
  EditLimits limits = randomLimits(random);
  expectEdit(s, tool, limits, wanted, either);
}

TEST(Scissors, CutWhatAnOrthographicViewEncloses) {
  forSamples(500, [](Random& random, Sample& s) { compare(random, s, orthographic(random)); });
}

TEST(Scissors, CutWhatAPerspectiveViewEncloses) {
  forSamples(500, [](Random& random, Sample& s) { compare(random, s, perspective(random, s)); });
}

/// A scan of 21 × 21 × 5 mm, all of it the label, seen along z: u is x, v is y.
Sample board() {
  Sample s = plainSample({21, 21, 5}, {1, 1, 1});
  for (auto& label : s.before.labels.labels) label = kValue;
  return s;
}

tool::Scissors alongZ(std::vector<Eigen::Vector2d> outline) {
  tool::Scissors tool;
  tool.view(0, 0) = 1.0;
  tool.view(1, 1) = 1.0;
  tool.view(2, 3) = 1.0;
  tool.outline = std::move(outline);
  return tool;
}

TEST(Scissors, TheMiddleOfAPentagramIsOutside) {
  std::vector<Eigen::Vector2d> star;
  for (int n = 0; n < 5; ++n) {
    const double angle = 0.3 + 2.0 * n * 2.0 * 3.14159265358979 / 5.0;
    star.emplace_back(10.0 + 9.7 * std::cos(angle), 10.0 + 9.7 * std::sin(angle));
  }
  const auto after = applied(board(), alongZ(star));
  ASSERT_TRUE(after);
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(after->labels.at(10, 10, k), kValue) << "crossed twice";
    const double u = 10.0 + 7.0 * std::cos(0.3);
    const double v = 10.0 + 7.0 * std::sin(0.3);
    EXPECT_EQ(
        after->labels.at(static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v)), k), 0)
        << "in a tip";
    EXPECT_EQ(after->labels.at(0, 0, k), kValue);
  }
}

TEST(Scissors, TheOutlineIsClosed) {
  // The last side, from (4.5, 15.5) to (4.5, 4.5), is not among the points.
  const auto after = applied(board(), alongZ({{4.5, 4.5}, {12.5, 4.5}, {12.5, 15.5}, {4.5, 15.5}}));
  ASSERT_TRUE(after);
  EXPECT_EQ(voxelsOf(after->labels, kValue), 5U * (441U - 8U * 11U));
  // Two given twice change nothing.
  const auto same =
      applied(board(),
              alongZ({{4.5, 4.5}, {4.5, 4.5}, {12.5, 4.5}, {12.5, 15.5}, {4.5, 15.5}, {4.5, 4.5}}));
  ASSERT_TRUE(same);
  EXPECT_TRUE(sameLabels(after->labels, same->labels));
}

TEST(Scissors, CutOnlyTheSlabOfThePlane) {
  tool::Scissors tool = alongZ({{4.5, 4.5}, {12.5, 4.5}, {12.5, 15.5}, {4.5, 15.5}});
  tool.plane_mm = Eigen::Vector4d(0, 0, 1, -2);
  for (const auto& [depth, slices] :
       {std::pair{0.0, 1U}, std::pair{0.99, 1U}, std::pair{1.0, 3U}}) {
    tool.depth_mm = depth;
    tool.keepInside = false;
    const auto cut = applied(board(), tool);
    ASSERT_TRUE(cut) << sentence(cut.error());
    EXPECT_EQ(voxelsOf(cut->labels, kValue), 5U * 441U - slices * 88U) << depth;
    tool.keepInside = true;
    const auto kept = applied(board(), tool);
    ASSERT_TRUE(kept) << sentence(kept.error());
    EXPECT_EQ(voxelsOf(kept->labels, kValue), 5U * 441U - slices * (441U - 88U)) << depth;
  }
}

TEST(Scissors, WhatIsBehindTheEyeStays) {
  // w = z - 1.5: two slices behind, three before; u = x / w, v = y / w.
  tool::Scissors tool;
  tool.view(0, 0) = 1.0;
  tool.view(1, 1) = 1.0;
  tool.view(2, 2) = 1.0;
  tool.view(2, 3) = -1.5;
  tool.outline = {{-1000, -1000}, {1000, -1000}, {1000, 1000}, {-1000, 1000}};
  const auto after = applied(board(), tool);
  ASSERT_TRUE(after) << sentence(after.error());
  EXPECT_EQ(voxelsOf(after->labels, kValue), 2U * 441U);
  EXPECT_EQ(after->labels.at(3, 3, 1), kValue);
  EXPECT_EQ(after->labels.at(3, 3, 2), 0);
  tool.outline = {{2000, 2000}, {3000, 2000}, {3000, 3000}};
  tool.keepInside = true;
  const auto outside = applied(board(), tool);
  ASSERT_TRUE(outside) << sentence(outside.error());
  EXPECT_EQ(voxelsOf(outside->labels, kValue), 2U * 441U);
  // w = 0 is behind.
  tool.view(2, 3) = -2.0;
  const auto touching = applied(board(), tool);
  ASSERT_TRUE(touching) << sentence(touching.error());
  EXPECT_EQ(voxelsOf(touching->labels, kValue), 3U * 441U);
}

}  // namespace
}  // namespace palpate::test
