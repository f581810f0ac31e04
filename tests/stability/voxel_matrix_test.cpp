/// What depends on voxels: their size, thin shells at speed, holes, deep starts. The whole
/// program's loop (voxel_loop.h); thresholds of haptics_facts.md §4.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/geometry/units.h"
#include "core/scene/instrument_mesh.h"
#include "tests/stability/matrix_report.h"
#include "tests/stability/test_hands.h"
#include "tests/stability/voxel_loop.h"

namespace palpate::stability {
namespace {

template <class T>
std::vector<T> some(const std::vector<T>& whole, const std::vector<T>& part) {
  return kWhole ? whole : part;
}

/// Goes straight down from a height at a speed, then waits where it wanted to get.
class Plunging final : public Hand {
 public:
  Plunging(double from, double to, double speed, bool upright = false)
      : from_(from), to_(to), speed_(speed), upright_(upright) {}
  HandTarget target(double t, const DeviceSample&, const Wrench&) noexcept override {
    const double y = std::max(to_, from_ - speed_ * std::max(0.0, t - 0.5));
    if (!upright_) return {stylusAtRest(y), 1, true};
    const Eigen::Quaterniond upright =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY());
    return {plain(Eigen::Vector3d(0, y, 0), upright), 1, true};
  }

 private:
  double from_, to_, speed_;
  bool upright_;
};

std::string words(const char* format, auto... values) {
  char text[160];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

Row judged(const std::string& name, double x, double y, const VoxelResult& r,
           const Thresholds& thresholds, Verdict worst) {
  Row row{name + ", seed 1", x, y, judge(r.samples, r.limits, r.report.penetrationMax, thresholds)};
  EXPECT_LE(row.judged.verdict, worst) << row.name << ": " << row.judged.why;
  return row;
}

/// A rod of 2 mm radius with a flat end.
Instrument peg() {
  Instrument out;
  out.name = "peg";
  const auto section = [](double z, double r) {
    CrossSection s;
    s.p_T = {0, 0, z};
    s.halfAxes = {r, r};
    return s;
  };
  const auto mesh = sweepSections({section(0, 2e-3), section(0.06, 2e-3)}, 32);
  EXPECT_TRUE(mesh);
  out.mesh_T = *mesh;
  out.massProperties = *massPropertiesOf(out.mesh_T, 4500.0);
  out.shellSpacing = 0.4e-3;
  return out;
}

// A slab of whatever voxels: pressed to about 1 N and held; at rest no deeper than half a voxel, on
// the way no deeper than one.
TEST(VoxelMatrix, PenetrationByVoxelSize) {
  std::vector<Row> rows;
  for (const double mm : some<double>({0.1, 0.2, 0.5, 1, 2, 5}, {0.1, 1, 5})) {
    VoxelCase c;
    c.voxel = metres(mm);
    c.dims = {96, 24, 96};
    if (mm >= 1.0) c.dims = {40, 16, 40};
    c.solid = [](double, double y, double) { return y < 0.0; };
    c.hand = std::make_shared<PressingHand>(0.03, -0.008);
    const VoxelResult r = runOnVoxels(c);
    double rest = 0.0;
    for (std::size_t i = r.steps.size() - 500; i < r.steps.size(); ++i) {
      rest = std::max(rest, r.steps[i].depth);
    }
    const std::string name = words("slab of %g mm voxels", mm);
    EXPECT_GT(r.report.forceMax, 0.5) << name;
    EXPECT_LE(rest, 0.5 * c.voxel) << name;
    EXPECT_LE(r.report.penetrationMax, c.voxel) << name;
    rows.push_back(judged(name, mm, 0.0, r, {0.08, c.voxel}, Verdict::Pass));
  }
  report("voxel-size", rows);
}

/// A sheet of one voxel, level or oblique: the tip must not get below it.
void sheetRow(double mm, double share, double slope, bool rod, std::vector<Row>& rows) {
  VoxelCase c;
  c.voxel = metres(mm);
  const auto side = static_cast<std::int32_t>(2.0 * std::clamp(30.0 / mm, 20.0, 60.0));
  c.dims = {side, side, side};
  const double middle = -c.voxel * (0.5 * side - 0.5);  // through voxel centres
  // Every voxel whose centre is within half a diagonal step of the plane: one voxel thick, and
  // closed for a point's way along faces.
  const double length = std::hypot(1.0, slope);
  const double thick = 0.5 * c.voxel * (1.0 + slope) / length;
  c.solid = [=](double x, double y, double) {
    return std::abs(y - middle - slope * x) / length <= thick;
  };
  const double speed = share * c.voxel / 1e-3;
  if (rod) c.instrument = peg();
  c.hand = std::make_shared<Plunging>(middle + 0.012, middle - 0.02, speed, rod);
  c.seconds = 1.0 + 0.032 / speed;
  const VoxelResult r = runOnVoxels(c);
  const std::string name = words("%s on a sheet of one %g mm voxel, slope %g, hand at %g m/s",
                                 rod ? "rod" : "burr", mm, slope, speed);
  // As long as the sheet is under the tip: until it slides off its edge.
  bool touched = false, through = false;
  const double edge = 0.5 * c.voxel * side - 3e-3;
  for (std::size_t i = 0; i < r.tip_D.size() && !through; ++i) {
    const Eigen::Vector3d& p = r.tip_D[i];
    touched = touched || r.steps[i].contacts > 0;
    if (std::max(std::abs(p.x()), std::abs(p.z())) > edge) break;
    through = (p.y() - middle - slope * p.x()) / length < -thick;
  }
  EXPECT_TRUE(touched) << name;
  EXPECT_FALSE(through) << name;
  Row row = judged(name, mm, share, r, {1.0, c.voxel}, Verdict::Guarded);
  if (through) row.judged.verdict = Verdict::Exception;
  rows.push_back(row);
}

// Whatever the hand's speed.
// (Above 2 m/s the velocity stop cuts the force; the tool stays above all the same.)
TEST(VoxelMatrix, ThinShellsAtSpeed) {
  std::vector<Row> rows;
  for (const double mm : some<double>({0.25, 0.5, 1, 2, 4}, {0.5, 1})) {
    for (const double share : some<double>({0.1, 0.5, 1, 2}, {0.5, 2})) {
      // 2: a level sheet, and a rod whose flat end meets it all at once.
      for (const double slope : some<double>({0.0, 0.3, 1.0, 2.0}, {0.3, 2.0})) {
        sheetRow(mm, share, slope == 2.0 ? 0.0 : slope, slope == 2.0, rows);
      }
    }
  }
  const MapAxes axes{"Sheets of one voxel and the hand's speed, Touch X", "voxel (mm)",
                     "speed (voxels a step)"};
  report("voxel-speed", rows, &axes);
}
/// Holds the rod upright and pushes it down a hole, beside its middle.
class Inserting final : public Hand {
 public:
  explicit Inserting(double beside) : beside_(beside) {}
  HandTarget target(double t, const DeviceSample&, const Wrench&) noexcept override {
    const double y = std::max(-0.012, 0.02 - 0.03 * std::max(0.0, t - 0.4));
    const Eigen::Quaterniond upright =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY());
    return {plain(Eigen::Vector3d(beside_, y, 0.0), upright), 1, true};
  }

 private:
  double beside_;
};

// The hole is so many tenths of a voxel wider than the rod. Distances between voxel centres round
// the wall, so a rod may stick at the mouth; it must hold still there, or slide in, without buzz.
TEST(VoxelMatrix, PegInHole) {
  std::vector<Row> rows;
  for (const double room : some<double>({0.1, 0.25, 0.5, 1.0}, {0.5})) {
    for (const double beside : some<double>({0.0, 0.5}, {0.5})) {
      VoxelCase c;
      c.voxel = 0.5e-3;
      c.dims = {48, 48, 48};
      const double radius = 2e-3 + room * c.voxel;
      c.solid = [radius](double x, double y, double z) {
        return y < 0.0 && std::hypot(x, z) > radius;
      };
      c.instrument = peg();
      c.hand = std::make_shared<Inserting>(beside * room * c.voxel);
      c.seconds = 4.0;
      const VoxelResult r = runOnVoxels(c);
      const std::string name = words("rod in a hole %g voxels wider, %g beside", room, beside);
      rows.push_back(judged(name, room, beside, r, {0.08, c.voxel}, Verdict::Pass));
      // At rest: drift at most 0.01 mm/s beyond the hand's tremor; the cap is a cap.
      Eigen::Vector3d early = Eigen::Vector3d::Zero(), late = early;
      for (std::size_t i = 0; i < 500; ++i) {
        early += r.tip_D[2500 + i] / 500.0;
        late += r.tip_D[3500 + i] / 500.0;
        EXPECT_LE(r.steps[3500 + i].impulses, 200u * r.steps[3500 + i].parts) << name;
      }
      EXPECT_LE((late - early).norm(), 0.01e-3 + 2e-5) << name;
    }
  }
  report("peg-in-hole", rows);
}

TEST(VoxelMatrix, DeepStarts) {
  std::vector<Row> rows;
  for (const double mm : some<double>({0.25, 0.5, 1, 2}, {1})) {
    VoxelCase c;
    c.voxel = metres(mm);
    c.dims = {48, 32, 48};
    c.solid = [](double, double y, double) { return y < 0.0; };
    c.hand = std::make_shared<Plunging>(-10.0 * c.voxel, -10.0 * c.voxel, 0.0);
    const VoxelResult r = runOnVoxels(c);
    const std::string name = words("start ten voxels of %g mm deep", mm);
    for (const ServoSample& s : r.samples) {
      ASSERT_EQ(std::hypot(s.wrench.force[0], s.wrench.force[1], s.wrench.force[2]), 0.0) << name;
    }
    for (std::size_t i = 1; i < r.tip_D.size(); ++i) {
      // 0.1 m/s, and twice that where several contacts push at once.
      ASSERT_LE((r.tip_D[i] - r.tip_D[i - 1]).norm(), 0.25e-3) << name << " step " << i;
    }
    rows.push_back(judged(name, mm, 0.0, r, {0.08, 12.0 * c.voxel}, Verdict::Pass));
  }
  report("deep-start", rows);
}

}  // namespace
}  // namespace palpate::stability
