#include "tests/imaging/segment/samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <sstream>

namespace palpate::test {
namespace {

constexpr std::array<std::uint8_t, 3> kValues{1, kValue, 9};

void fillBox(Random& random, LabelGrid& grid, std::uint8_t value, bool hollow) {
  const auto& d = grid.geometry.dims;
  std::array<int, 3> low{};
  std::array<int, 3> high{};
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = random.whole(0, d[a] - 1);
    high[a] = random.whole(low[a], d[a] - 1);
  }
  for (int k = low[2]; k <= high[2]; ++k)
    for (int j = low[1]; j <= high[1]; ++j)
      for (int i = low[0]; i <= high[0]; ++i) {
        const bool face = i == low[0] || i == high[0] || j == low[1] || j == high[1] ||
                          k == low[2] || k == high[2];
        if (face || !hollow) grid.labels[grid.geometry.index(i, j, k)] = value;
      }
}

void dust(Random& random, LabelGrid& grid, std::uint8_t value, int percent) {
  for (auto& label : grid.labels) {
    if (random.chance(percent)) label = value;
  }
}

/// Dust, blocks, shells with dust in and around them, a full scan, a scan without the label.
void randomLabels(Random& random, LabelGrid& grid) {
  grid.labels.assign(grid.geometry.voxelCount(), 0);
  const int style = random.whole(0, 9);
  if (style == 0) {
    std::fill(grid.labels.begin(), grid.labels.end(), kValue);
  } else if (style <= 3) {
    for (const std::uint8_t value : kValues) dust(random, grid, value, random.whole(1, 40));
    if (random.chance(50)) dust(random, grid, kValue, random.whole(20, 70));
  } else if (style <= 8) {
    for (int n = random.whole(1, 4); n > 0; --n) {
      const auto value = kValues[static_cast<std::size_t>(random.whole(0, 2))];
      fillBox(random, grid, value, false);
    }
    for (int n = random.whole(1, 3); n > 0; --n) fillBox(random, grid, kValue, random.chance(60));
    for (const int value : {0, 1, 4, 9}) {
      dust(random, grid, static_cast<std::uint8_t>(value), random.whole(0, 6));
    }
  } else {
    dust(random, grid, 1, 30);
  }
}

void randomValues(Random& random, Volume& volume) {
  const std::size_t n = volume.geometry.voxelCount();
  if (random.chance(60)) {
    volume.int16.resize(n);
    for (auto& v : volume.int16) v = static_cast<std::int16_t>(random.whole(kLowest, kHighest));
    return;
  }
  volume.type = VoxelType::Float32;
  volume.float32.resize(n);
  for (auto& v : volume.float32) {
    v = static_cast<float>(random.whole(2 * kLowest, 2 * kHighest)) / 2.0F;
    if (random.chance(3)) v = std::numeric_limits<float>::quiet_NaN();
  }
}

std::string voxelText(const GridGeometry& geometry, std::size_t index) {
  const Voxel v = voxelOf(geometry, index);
  std::ostringstream text;
  text << "(" << v.i << ", " << v.j << ", " << v.k << ")";
  return text.str();
}

}  // namespace

Mask Sample::label() const {
  Mask mask(size());
  for (std::size_t i = 0; i < size(); ++i) mask[i] = holds(i) ? 1 : 0;
  return mask;
}

GridGeometry randomGeometry(Random& random, const std::array<std::int32_t, 3>& dims) {
  GridGeometry g;
  g.dims = dims;
  g.spacing = random.point(0.3, 2.5) * 1e-3;
  if (random.chance(25)) return g;
  const double angle = random.real(-3.1, 3.1);
  g.X_PV.linear() =
      Eigen::AngleAxisd(angle, random.point(-1.0, 1.0).normalized()).toRotationMatrix();
  g.X_PV.translation() = random.point(-0.2, 0.2);
  return g;
}

Sample randomSample(Random& random, int maxSize) {
  Sample s;
  std::array<std::int32_t, 3> dims{};
  for (auto& d : dims) d = random.whole(1, maxSize);
  s.volume.geometry = randomGeometry(random, dims);
  s.volume.modality = "CT";
  randomValues(random, s.volume);
  s.before.labels.geometry = s.volume.geometry;
  randomLabels(random, s.before.labels);
  s.before.table = {{.name = "nerve", .value = 9, .colour = {1, 2, 3}, .material = "nerve"},
                    {.name = kLabel, .value = kValue, .colour = {9, 8, 7}, .material = "tooth"},
                    {.name = "bone", .value = 1}};
  return s;
}

Sample sampleOfSeed(Random& random, unsigned seed) {
  return randomSample(random, static_cast<int>(std::min(9U, 1 + seed / 10)));
}

Sample plainSample(const std::array<std::int32_t, 3>& dims, const Eigen::Vector3d& spacing_mm) {
  Random random(1);
  Sample s = randomSample(random);
  s.volume = {};
  s.volume.modality = "CT";
  s.volume.geometry.dims = dims;
  s.volume.geometry.spacing = spacing_mm * 1e-3;
  s.volume.int16.assign(s.volume.geometry.voxelCount(), 0);
  s.before.labels.geometry = s.volume.geometry;
  s.before.labels.labels.assign(s.size(), 0);
  return s;
}

ThresholdRange randomRange(Random& random) {
  const int low = random.whole(kLowest - 1, kHighest + 1);
  const int high = random.whole(low, kHighest + 1);
  return {static_cast<double>(low), static_cast<double>(high)};
}

EditLimits randomLimits(Random& random) {
  EditLimits limits;
  limits.overOthers = random.chance(50);
  if (random.chance(35)) limits.only = randomRange(random);
  return limits;
}

bool inRange(const Volume& volume, std::size_t i, const ThresholdRange& range) {
  return volume.value(i) >= range.low && volume.value(i) <= range.high;
}

Voxel voxelOf(const GridGeometry& geometry, std::size_t index) {
  const auto nx = static_cast<std::size_t>(geometry.dims[0]);
  const auto ny = static_cast<std::size_t>(geometry.dims[1]);
  return {static_cast<std::int32_t>(index % nx), static_cast<std::int32_t>(index / nx % ny),
          static_cast<std::int32_t>(index / nx / ny)};
}

Eigen::Vector3d at_mm(const GridGeometry& geometry, double i, double j, double k) {
  return geometry.X_PV * geometry.centre_V(i, j, k) * 1e3;
}

Eigen::Vector3d centre_mm(const GridGeometry& geometry, std::size_t index) {
  const Voxel v = voxelOf(geometry, index);
  return at_mm(geometry, v.i, v.j, v.k);
}

Eigen::Vector3d somewhereIn_mm(Random& random, const GridGeometry& geometry, std::size_t index) {
  const Voxel v = voxelOf(geometry, index);
  const Eigen::Vector3d off = random.point(-0.45, 0.45);
  return at_mm(geometry, v.i + off.x(), v.j + off.y(), v.k + off.z());
}

double voxelMm3(const GridGeometry& geometry) {
  return geometry.spacing.x() * 1e3 * (geometry.spacing.y() * 1e3) * (geometry.spacing.z() * 1e3);
}

void forNeighbours(const GridGeometry& geometry, std::size_t index, int connectivity,
                   const std::function<void(std::size_t)>& visit) {
  const Voxel v = voxelOf(geometry, index);
  for (int dk = -1; dk <= 1; ++dk)
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di) {
        const int steps = std::abs(di) + std::abs(dj) + std::abs(dk);
        if (steps == 0 || (connectivity == 6 && steps > 1)) continue;
        if (!geometry.contains(v.i + di, v.j + dj, v.k + dk)) continue;
        visit(geometry.index(v.i + di, v.j + dj, v.k + dk));
      }
}

Mask flooded(const Mask& mask, const Part& starts, const GridGeometry& geometry, int connectivity) {
  Mask reached(mask.size(), 0);
  std::queue<std::size_t> todo;
  const auto reach = [&](std::size_t i) {
    if (mask[i] == 0 || reached[i] != 0) return;
    reached[i] = 1;
    todo.push(i);
  };
  for (const std::size_t start : starts) reach(start);
  while (!todo.empty()) {
    const std::size_t from = todo.front();
    todo.pop();
    forNeighbours(geometry, from, connectivity, reach);
  }
  return reached;
}

std::vector<Part> partsOf(const Mask& mask, const GridGeometry& geometry, int connectivity) {
  std::vector<Part> parts;
  Mask left = mask;
  std::vector<std::size_t> todo;
  for (std::size_t first = 0; first < left.size(); ++first) {
    if (left[first] == 0) continue;
    Part part;
    left[first] = 0;
    todo.push_back(first);
    while (!todo.empty()) {
      const std::size_t from = todo.back();
      todo.pop_back();
      part.push_back(from);
      forNeighbours(geometry, from, connectivity, [&](std::size_t next) {
        if (left[next] == 0) return;
        left[next] = 0;
        todo.push_back(next);
      });
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

std::size_t countOf(const Mask& mask) {
  return static_cast<std::size_t>(
      std::count_if(mask.begin(), mask.end(), [](std::uint8_t m) { return m != 0; }));
}

std::size_t voxelsOf(const LabelGrid& labels, std::uint8_t value) {
  return static_cast<std::size_t>(std::count(labels.labels.begin(), labels.labels.end(), value));
}

Result<LabelState> applied(const Sample& sample, const LabelTool& tool, const EditLimits& limits,
                           const std::string& label) {
  LabelStep step;
  step.label = label;
  step.tool = tool;
  step.limits = limits;
  try {
    return applyStep(sample.volume, sample.before, step);
  } catch (const std::exception& thrown) {  // errors are returned, never thrown
    ADD_FAILURE() << thrown.what() << "\n" << describe(sample);
    return fail(machineError(thrown.what()));
  }
}

LabelGrid edited(const Sample& sample, const EditLimits& limits, const Mask& wanted,
                 bool takesOthers) {
  LabelGrid out = sample.before.labels;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    if (limits.only && !inRange(sample.volume, i, *limits.only)) continue;
    const std::uint8_t now = out.labels[i];
    if (wanted[i] == 0 && now == kValue) out.labels[i] = 0;
    if (wanted[i] != 0 && (now == 0 || takesOthers || limits.overOthers)) out.labels[i] = kValue;
  }
  return out;
}

void expectEdit(const Sample& sample, const LabelTool& tool, const EditLimits& limits,
                const Mask& wanted, const Mask& either, bool takesOthers) {
  Mask more = wanted;
  Mask less = wanted;
  for (std::size_t i = 0; i < either.size(); ++i) {
    if (either[i] == 0) continue;
    more[i] = 1;
    less[i] = 0;
  }
  const LabelGrid most = edited(sample, limits, more, takesOthers);
  const LabelGrid least = edited(sample, limits, less, takesOthers);
  const LabelState before = sample.before;
  const auto after = applied(sample, tool, limits);
  EXPECT_TRUE(sameState(sample.before, before)) << "the labels before were changed";
  if (!after) {
    EXPECT_EQ(voxelsOf(least, kValue), 0U) << sentence(after.error()) << "\n" << describe(sample);
    EXPECT_EQ(after.error().kind, ErrorKind::InputRefused) << sentence(after.error());
    return;
  }
  EXPECT_GT(voxelsOf(most, kValue), 0U) << "a label without a voxel must be refused\n"
                                        << describe(sample);
  LabelGrid expected = most;
  for (std::size_t i = 0; i < sample.size() && i < after->labels.labels.size(); ++i) {
    if (after->labels.labels[i] == least.labels[i]) expected.labels[i] = least.labels[i];
  }
  EXPECT_TRUE(sameLabels(expected, after->labels)) << describe(sample);
  EXPECT_TRUE(sameTable(after->table, before.table));
}

void expectEditOrRefusal(const Sample& sample, const LabelTool& tool, const EditLimits& limits,
                         const Mask& wanted, const Mask& either, bool takesOthers) {
  const auto after = applied(sample, tool, limits);
  if (after) return expectEdit(sample, tool, limits, wanted, either, takesOthers);
  EXPECT_EQ(after.error().kind, ErrorKind::InputRefused) << sentence(after.error());
}

void expectRefused(const Sample& sample, const LabelTool& tool, ErrorKind kind,
                   const EditLimits& limits, const std::string& label) {
  const LabelState before = sample.before;
  const auto after = applied(sample, tool, limits, label);
  EXPECT_TRUE(sameState(sample.before, before)) << "the labels before were changed";
  ASSERT_FALSE(after) << "was accepted";
  EXPECT_EQ(kindName(after.error().kind), std::string(kindName(kind))) << sentence(after.error());
  EXPECT_FALSE(after.error().message.empty());
}

bool sameRow(const LabelInfo& a, const LabelInfo& b) {
  return a.name == b.name && a.value == b.value && a.colour == b.colour && a.material == b.material;
}

bool sameTable(const LabelTable& a, const LabelTable& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), sameRow);
}

bool sameState(const LabelState& a, const LabelState& b) {
  return a.labels.labels == b.labels.labels && a.labels.geometry.dims == b.labels.geometry.dims &&
         sameTable(a.table, b.table);
}

::testing::AssertionResult sameLabels(const LabelGrid& expected, const LabelGrid& got) {
  if (got.labels.size() != expected.labels.size()) {
    return ::testing::AssertionFailure()
           << got.labels.size() << " voxels instead of " << expected.labels.size();
  }
  if (got.geometry.dims != expected.geometry.dims ||
      got.geometry.spacing != expected.geometry.spacing ||
      got.geometry.X_PV.matrix() != expected.geometry.X_PV.matrix()) {
    return ::testing::AssertionFailure() << "another geometry";
  }
  std::size_t wrong = 0;
  std::string first;
  for (std::size_t i = 0; i < got.labels.size(); ++i) {
    if (got.labels[i] == expected.labels[i]) continue;
    if (wrong++ > 7) continue;
    first += "\n  " + voxelText(expected.geometry, i) + " is " + std::to_string(got.labels[i]) +
             ", expected " + std::to_string(expected.labels[i]);
  }
  if (wrong == 0) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << wrong << " voxels differ:" << first;
}

std::string describe(const Sample& sample) {
  const GridGeometry& g = sample.geometry();
  std::ostringstream text;
  text << "dims " << g.dims[0] << " " << g.dims[1] << " " << g.dims[2] << ", spacing "
       << g.spacing.transpose() * 1e3 << " mm";
  if (sample.size() > 100) return text.str();
  text << "\nlabels before:";
  for (std::size_t i = 0; i < sample.before.labels.labels.size(); ++i) {
    text << " " << static_cast<int>(sample.before.labels.labels[i]);
  }
  text << "\nvalues:";
  for (std::size_t i = 0; i < sample.size(); ++i) text << " " << sample.volume.value(i);
  return text.str();
}

void forSamples(unsigned count, const std::function<void(Random&, Sample&)>& test) {
  for (unsigned seed = 1; seed <= count; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Sample sample = sampleOfSeed(random, seed);
    test(random, sample);
    if (::testing::Test::HasFailure()) return;
  }
}

}  // namespace palpate::test
