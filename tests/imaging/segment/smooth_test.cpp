/// tool::Smooth: what it must do to balls, sheets, bars and grains, and a Gaussian of its own.

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>

#include "tests/imaging/segment/samples.h"

namespace palpate::test {
namespace {

void fill(Sample& s, const std::function<bool(const Voxel&)>& in) {
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (in(voxelOf(s.geometry(), i))) s.before.labels.labels[i] = kValue;
  }
}

Mask maskOf(const LabelGrid& labels) {
  Mask mask(labels.labels.size());
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = labels.labels[i] == kValue ? 1 : 0;
  return mask;
}

/// The blurred mask with `outside` beyond the scan: a sampled Gaussian to six deviations, an axis
/// after the other.
std::vector<double> blurred(const Mask& mask, const GridGeometry& g, double mm, double outside) {
  std::vector<double> values(mask.begin(), mask.end());
  for (int axis = 0; axis < 3; ++axis) {
    const double step = g.spacing[axis] * 1e3;
    const int reach = static_cast<int>(std::ceil(6.0 * mm / step));
    std::vector<double> next(values.size(), 0.0);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Voxel v = voxelOf(g, i);
      double sum = 0.0;
      double weights = 0.0;
      for (int d = -reach; d <= reach; ++d) {
        const double weight = std::exp(-0.5 * std::pow(d * step / mm, 2));
        std::array<int, 3> at{v.i, v.j, v.k};
        at[static_cast<std::size_t>(axis)] += d;
        weights += weight;
        sum += weight *
               (g.contains(at[0], at[1], at[2]) ? values[g.index(at[0], at[1], at[2])] : outside);
      }
      next[i] = sum / weights;
    }
    values = std::move(next);
  }
  return values;
}

// What counts beyond the scan is not said: a voxel is decided where label and background beyond
// agree. A sampled Gaussian and one averaged over voxels differ by less than 0.03 from one voxel
// of deviation on.
TEST(Smooth, IsAGaussianCutAtOneHalf) {
  std::size_t decided = 0;
  std::size_t all = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    Sample s = plainSample({23, 19, 21}, random.point(0.4, 1.0));
    s.volume.geometry.X_PV = randomGeometry(random, {1, 1, 1}).X_PV;
    s.before.labels.geometry = s.volume.geometry;
    for (int n = 0; n < 5; ++n) {
      const Eigen::Vector3d middle(random.real(0, 22), random.real(0, 18), random.real(0, 20));
      const double radius = random.real(2.0, 7.0);
      fill(s, [&](const Voxel& v) {
        return (Eigen::Vector3d(v.i, v.j, v.k) - middle).norm() <= radius;
      });
    }
    for (auto& label : s.before.labels.labels) {
      if (random.chance(10)) label = label == 0 ? kValue : std::uint8_t{0};
    }
    const double mm = random.real(1.0, 2.0);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", mm " + std::to_string(mm));
    const auto low = blurred(s.label(), s.geometry(), mm, 0.0);
    const auto high = blurred(s.label(), s.geometry(), mm, 1.0);
    Mask wanted(s.size(), 0);
    Mask either(s.size(), 0);
    for (std::size_t i = 0; i < s.size(); ++i) {
      wanted[i] = low[i] > 0.53 ? 1 : 0;
      either[i] = wanted[i] == 0 && high[i] >= 0.47 ? 1 : 0;
      decided += either[i] == 0 ? 1 : 0;
    }
    all += s.size();
    expectEdit(s, tool::Smooth{.mm = mm, .keepThin = false}, randomLimits(random), wanted, either);
    if (HasFailure()) return;
  }
  EXPECT_GT(static_cast<double>(decided), 0.6 * static_cast<double>(all)) << "the oracle is idle";
}

/// Its oracle in the large: each spacing and deviation meets its own axis.
/// A sampled Gaussian cut at three deviations, whole voxels; what of it is beyond the scan counts
/// for nothing, the rest is scaled to one.
std::vector<double> cutBlur(const Mask& mask, const GridGeometry& g, double mm) {
  std::vector<double> values(mask.begin(), mask.end());
  for (int axis = 0; axis < 3; ++axis) {
    const double deviation = mm / (g.spacing[axis] * 1e3);
    const int reach = static_cast<int>(3.0 * deviation);
    std::vector<double> next(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Voxel v = voxelOf(g, i);
      double sum = 0.0;
      double weights = 0.0;
      for (int d = -reach; d <= reach; ++d) {
        std::array<int, 3> at{v.i, v.j, v.k};
        at[static_cast<std::size_t>(axis)] += d;
        if (!g.contains(at[0], at[1], at[2])) continue;
        const double weight = std::exp(-0.5 * std::pow(d / deviation, 2));
        weights += weight;
        sum += weight * values[g.index(at[0], at[1], at[2])];
      }
      next[i] = sum / weights;
    }
    values = std::move(next);
  }
  return values;
}

TEST(Smooth, EqualsItsOwnGaussianToRounding) {
  forSamples(200, [](Random& random, Sample& s) {
    const double mm = random.real(0.2, 3.0);
    const std::vector<double> blur = cutBlur(s.label(), s.geometry(), mm);
    Mask wanted(s.size()), either(s.size());
    for (std::size_t i = 0; i < s.size(); ++i) {
      wanted[i] = blur[i] > 0.5 ? 1 : 0;
      either[i] = std::abs(blur[i] - 0.5) < 1e-5 ? 1 : 0;  // VTK sums in single precision
    }
    expectEditOrRefusal(s, tool::Smooth{.mm = mm, .keepThin = false}, randomLimits(random), wanted,
                        either);
  });
}

TEST(Smooth, TheDeviationIsInMillimetresOnEachAxis) {
  // A plate of thickness t keeps its middle while erf(t / 2√2σ) > 1/2, that is t > 1.349 σ.
  for (int axis = 0; axis < 3; ++axis) {
    for (const double spacing : {0.25, 0.5}) {
      Eigen::Vector3d spacings(1.0, 1.1, 0.9);
      spacings[axis] = spacing;
      std::array<std::int32_t, 3> dims{8, 8, 8};
      dims[static_cast<std::size_t>(axis)] = 48;
      for (const double mm : {1.0, 1.6}) {
        const auto survives = [&](double thickness) {
          Sample s = plainSample(dims, spacings);
          const int voxels = static_cast<int>(std::lround(thickness / spacing));
          fill(s, [&](const Voxel& v) {
            const int at = std::array{v.i, v.j, v.k}[static_cast<std::size_t>(axis)];
            return at >= 24 && at < 24 + voxels;
          });
          return applied(s, tool::Smooth{.mm = mm, .keepThin = false}).has_value();
        };
        SCOPED_TRACE("axis " + std::to_string(axis) + ", mm " + std::to_string(mm));
        EXPECT_TRUE(survives(1.349 * mm + 0.75 * spacing + 0.1));
        EXPECT_FALSE(survives(1.349 * mm - 0.75 * spacing - 0.1));
      }
    }
  }
}

TEST(Smooth, ABallKeepsItsRadius) {
  for (const bool keepThin : {false, true}) {
    for (const double mm : {0.5, 1.0, 1.5}) {
      Sample s = plainSample({33, 41, 25}, {0.8, 0.6, 1.0});
      const Eigen::Vector3d middle = at_mm(s.geometry(), 16, 20, 12);
      const double radius = 9.0;
      fill(s, [&](const Voxel& v) {
        return (at_mm(s.geometry(), v.i, v.j, v.k) - middle).norm() <= radius;
      });
      const auto after = applied(s, tool::Smooth{.mm = mm, .keepThin = keepThin});
      ASSERT_TRUE(after) << sentence(after.error());
      const double mm3 =
          static_cast<double>(voxelsOf(after->labels, kValue)) * voxelMm3(s.geometry());
      const double now = std::cbrt(mm3 * 3.0 / (4.0 * std::numbers::pi));
      EXPECT_NEAR(now, radius, 0.3) << "mm " << mm << ", keepThin " << keepThin;
    }
  }
}

/// A scan of 0.5 mm with a ball of 4 mm radius in its low corner, so that the label stays.
Sample withBall() {
  Sample s = plainSample({56, 56, 56}, {0.5, 0.5, 0.5});
  fill(s, [](const Voxel& v) {
    return std::pow(v.i - 10, 2) + std::pow(v.j - 10, 2) + std::pow(v.k - 10, 2) <= 64.0;
  });
  return s;
}

struct Shape {
  const char* name;
  std::function<bool(const Voxel&)> in;
};

/// All of the shape that is there after smoothing, and all that was.
std::pair<std::size_t, std::size_t> left(const Shape& shape, double mm, bool keepThin) {
  Sample s = withBall();
  Mask added(s.size(), 0);
  for (std::size_t i = 0; i < s.size(); ++i) {
    added[i] = !s.holds(i) && shape.in(voxelOf(s.geometry(), i)) ? 1 : 0;
  }
  fill(s, shape.in);
  const auto after = applied(s, tool::Smooth{.mm = mm, .keepThin = keepThin});
  EXPECT_TRUE(after) << shape.name;
  std::size_t kept = 0;
  for (std::size_t i = 0; after && i < s.size(); ++i) {
    if (added[i] != 0 && after->labels.labels[i] == kValue) ++kept;
  }
  return {kept, countOf(added)};
}

TEST(Smooth, ThinSheetsAndBarsStayWhenKept) {
  // All of them stand clear of the ball; each is at least 10 mm long, six times the deviation 6.
  const auto in = [](int x, int low, int high) { return x >= low && x <= high; };
  const std::vector<Shape> shapes{
      {"sheet across x",
       [&](const Voxel& v) { return v.i == 40 && in(v.j, 9, 45) && in(v.k, 7, 50); }},
      {"sheet across y",
       [&](const Voxel& v) { return v.j == 40 && in(v.k, 9, 45) && in(v.i, 7, 50); }},
      {"sheet across z",
       [&](const Voxel& v) { return v.k == 40 && in(v.i, 9, 45) && in(v.j, 7, 50); }},
      {"oblique sheet",
       [&](const Voxel& v) { return v.i + v.j == 75 && in(v.i, 25, 50) && in(v.k, 9, 50); }},
      {"bar along x", [&](const Voxel& v) { return v.j == 40 && v.k == 40 && in(v.i, 15, 40); }},
      {"bar along y", [&](const Voxel& v) { return v.i == 40 && v.k == 40 && in(v.j, 15, 40); }},
      {"bar along z", [&](const Voxel& v) { return v.i == 40 && v.j == 40 && in(v.k, 15, 40); }},
      {"oblique bar", [&](const Voxel& v) { return v.i == v.j && v.j == v.k && in(v.i, 25, 45); }}};
  for (const Shape& shape : shapes) {
    SCOPED_TRACE(shape.name);
    const auto [kept, all] = left(shape, 1.0, true);
    EXPECT_EQ(kept, all);
    EXPECT_EQ(left(shape, 1.0, false).first, 0U);
  }
}

TEST(Smooth, SixTimesTheDeviationDividesBarsFromGrains) {
  // 0.5 mm a voxel; the length of a bar is taken from face to face or from centre to centre.
  for (int axis = 0; axis < 3; ++axis) {
    const auto bar = [&](int voxels) {
      return Shape{"bar", [=](const Voxel& v) {
                     std::array<int, 3> at{v.i, v.j, v.k};
                     const auto a = static_cast<std::size_t>(axis);
                     return at[a] >= 20 && at[a] < 20 + voxels && at[(a + 1) % 3] == 40 &&
                            at[(a + 2) % 3] == 40;
                   }};
    };
    SCOPED_TRACE("axis " + std::to_string(axis));
    for (const auto& [mm, longer, shorter] :
         {std::tuple{1.0, 14, 11}, std::tuple{0.5, 8, 5}, std::tuple{2.0, 26, 23}}) {
      EXPECT_EQ(left(bar(longer), mm, true).first, static_cast<std::size_t>(longer)) << mm;
      EXPECT_EQ(left(bar(shorter), mm, true).first, 0U) << mm;
    }
  }
}

TEST(Smooth, ALengthIsTheDiagonalOfAPartsBox) {
  const auto bar = [](int voxels) {
    return Shape{"oblique bar", [=](const Voxel& v) {
                   return v.i == v.j && v.j == v.k && v.i >= 30 && v.i < 30 + voxels;
                 }};
  };
  EXPECT_EQ(left(bar(8), 1.0, true).first, 8U);  // 6.9 mm, of 4 mm along each axis
  EXPECT_EQ(left(bar(6), 1.0, true).first, 0U);  // 5.2 mm
}

/// Within mm of the mask, all pairs of centres.
Mask within(const GridGeometry& g, const Mask& mask, double mm) {
  Mask near(mask.size(), 0);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask[i] == 0) continue;
    const Eigen::Vector3d from = centre_mm(g, i);
    for (std::size_t j = 0; j < mask.size(); ++j) {
      if (near[j] == 0 && (centre_mm(g, j) - from).squaredNorm() <= mm * mm * (1.0 + 1e-5)) {
        near[j] = 1;
      }
    }
  }
  return near;
}

/// What smooth.cpp says is thin: no ball fits into it, and it is within two radii of what is
/// farther than one from every ball, in pieces six deviations long.
Mask thinOf(const Sample& s, double mm) {
  const GridGeometry& g = s.geometry();
  const Eigen::Vector3d spacing_mm = g.spacing * 1e3;
  const double radius = std::max(mm, spacing_mm.maxCoeff());
  const Mask mask = s.label();
  Mask outside(mask.size()), middle(mask.size()), core(mask.size()), thin(mask.size());
  for (std::size_t i = 0; i < mask.size(); ++i) outside[i] = mask[i] == 0 ? 1 : 0;
  const Mask shrunk = within(g, outside, radius);
  for (std::size_t i = 0; i < mask.size(); ++i) core[i] = shrunk[i] == 0 ? 1 : 0;
  const Mask balls = within(g, core, radius);
  const Mask beside = within(g, balls, radius);
  for (std::size_t i = 0; i < mask.size(); ++i) middle[i] = mask[i] != 0 && beside[i] == 0 ? 1 : 0;
  const Mask around = within(g, middle, 2.0 * radius);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    thin[i] = mask[i] != 0 && balls[i] == 0 && around[i] != 0 ? 1 : 0;
  }
  for (const Part& part : partsOf(thin, g, 26)) {
    Eigen::Array3d low = Eigen::Array3d::Constant(1e9), high = -low;
    for (const std::size_t i : part) {
      const Voxel v = voxelOf(g, i);
      low = low.min(Eigen::Array3d(v.i, v.j, v.k));
      high = high.max(Eigen::Array3d(v.i, v.j, v.k));
    }
    if (((high - low + 1.0) * spacing_mm.array()).matrix().norm() >= 6.0 * mm) continue;
    for (const std::size_t i : part) thin[i] = 0;
  }
  return thin;
}

/// Boxes of any shape, sheets and bars among them, that touch or stand apart.
Sample randomBoxes(Random& random) {
  Sample s = plainSample({random.whole(8, 16), random.whole(8, 13), random.whole(6, 11)},
                         random.point(0.4, 1.1));
  for (int n = random.whole(1, 5); n > 0; --n) {
    std::array<int, 3> low{}, high{};
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = random.whole(0, s.geometry().dims[d] - 1);
      high[d] = random.chance(40) ? low[d] : low[d] + random.whole(0, 12);
    }
    fill(s, [&](const Voxel& v) {
      return v.i >= low[0] && v.i <= high[0] && v.j >= low[1] && v.j <= high[1] && v.k >= low[2] &&
             v.k <= high[2];
    });
  }
  return s;
}

TEST(Smooth, KeepThinAddsWhatItsDefinitionSays) {
  std::size_t added = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Sample s = randomBoxes(random);
    const double mm = random.real(0.3, 1.2);
    const auto plain = applied(s, tool::Smooth{.mm = mm, .keepThin = false});
    const auto kept = applied(s, tool::Smooth{.mm = mm});
    Mask wanted = thinOf(s, mm);
    for (std::size_t i = 0; i < s.size(); ++i) {
      const bool in = plain && plain->labels.labels[i] == kValue;
      if (!in && wanted[i] != 0) ++added;
      if (in) wanted[i] = 1;
    }
    if (countOf(wanted) == 0) {
      EXPECT_FALSE(kept);
      continue;
    }
    ASSERT_TRUE(kept) << sentence(kept.error());
    for (std::size_t i = 0; i < s.size(); ++i) {
      ASSERT_EQ(kept->labels.labels[i] == kValue, wanted[i] != 0) << i << ", " << mm << " mm";
    }
  }
  EXPECT_GT(added, 500U) << "the samples show too little";
}

/// A slab through the whole scan, so that it has no edge of its own.
Sample slab() {
  Sample s = plainSample({30, 31, 32}, {0.5, 0.5, 0.5});
  fill(s, [](const Voxel& v) { return v.k >= 8 && v.k < 22; });
  return s;
}

TEST(Smooth, PimplesPitsAndGrainsGo) {
  for (const bool keepThin : {false, true}) {
    SCOPED_TRACE(keepThin);
    const Sample plain = slab();
    Sample s = slab();
    for (int n = 5; n < 28; n += 6) {
      s.before.labels.labels[s.geometry().index(n, n, 22)] = kValue;      // on the upper face
      s.before.labels.labels[s.geometry().index(n, 30 - n, 7)] = kValue;  // on the lower face
      s.before.labels.labels[s.geometry().index(n, 4, 27)] = kValue;      // apart
      s.before.labels.labels[s.geometry().index(n, 15, 21)] = 0;          // a pit
      s.before.labels.labels[s.geometry().index(n, 15, 14)] = 0;          // a bubble
    }
    const auto after = applied(s, tool::Smooth{.mm = 1.0, .keepThin = keepThin});
    ASSERT_TRUE(after) << sentence(after.error());
    // At the scan's edge nothing is said of what lies beyond.
    for (std::size_t i = 0; i < s.size(); ++i) {
      const Voxel v = voxelOf(s.geometry(), i);
      if (std::min({v.i, v.j, 29 - v.i, 30 - v.j}) < 5) continue;
      ASSERT_EQ(after->labels.labels[i], plain.before.labels.labels[i])
          << v.i << " " << v.j << " " << v.k;
    }
  }
}

TEST(Smooth, ThinBoneOnThickBoneStays) {
  Sample s = slab();
  Mask sheet(s.size(), 0);
  for (int k = 22; k < 30; ++k)
    for (int j = 4; j < 27; ++j) sheet[s.geometry().index(15, j, k)] = 1;
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (sheet[i] != 0) s.before.labels.labels[i] = kValue;
  }
  const auto kept = applied(s, tool::Smooth{.mm = 1.0, .keepThin = true});
  ASSERT_TRUE(kept) << sentence(kept.error());
  // A ball of 1 mm within the slab reaches its first row, which is therefore the blur's to decide.
  std::size_t gone = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (sheet[i] != 0 && voxelOf(s.geometry(), i).k > 22 && kept->labels.labels[i] != kValue)
      ++gone;
  }
  EXPECT_EQ(gone, 0U);
  const auto cut = applied(s, tool::Smooth{.mm = 1.0, .keepThin = false});
  ASSERT_TRUE(cut) << sentence(cut.error());
  EXPECT_EQ(cut->labels.at(15, 15, 27), 0);
}

/// What keepThin adds to the blur was labelled before.
TEST(Smooth, KeepThinAddsOnlyWhatWasLabelled) {
  forSamples(200, [](Random& random, Sample& s) {
    const double mm = random.real(0.3, 3.0);
    const auto cut = applied(s, tool::Smooth{.mm = mm, .keepThin = false});
    const auto kept = applied(s, tool::Smooth{.mm = mm, .keepThin = true});
    if (!kept) {
      EXPECT_FALSE(cut) << "the blur alone leaves something";
      return;
    }
    for (std::size_t i = 0; i < s.size(); ++i) {
      if (kept->labels.labels[i] != kValue || s.holds(i)) continue;
      ASSERT_TRUE(cut) << describe(s);
      EXPECT_EQ(cut->labels.labels[i], kValue) << describe(s);
    }
  });
}

TEST(Smooth, PartsFartherApartThanTwiceTheDeviationStayApart) {
  for (const bool keepThin : {false, true}) {
    Sample s = plainSample({40, 40, 41}, {0.5, 0.5, 0.5});
    fill(s, [](const Voxel& v) {  // faces 2.5 mm apart over 12 mm of width
      return v.i >= 8 && v.i < 32 && v.j >= 8 && v.j < 32 &&
             ((v.k >= 6 && v.k < 18) || (v.k >= 23 && v.k < 35));
    });
    ASSERT_EQ(partsOf(s.label(), s.geometry(), 26).size(), 2U);
    const auto after = applied(s, tool::Smooth{.mm = 1.0, .keepThin = keepThin});
    ASSERT_TRUE(after) << sentence(after.error());
    EXPECT_EQ(partsOf(maskOf(after->labels), s.geometry(), 26).size(), 2U);
    for (int k = 19; k < 22; ++k) EXPECT_EQ(after->labels.at(20, 20, k), 0);
  }
}

TEST(Smooth, TouchesOtherLabelsOnlyWhenItMay) {
  forSamples(200, [](Random& random, Sample& s) {
    tool::Smooth tool{.mm = random.real(0.3, 3.0), .keepThin = random.chance(50)};
    EditLimits limits = randomLimits(random);
    limits.overOthers = false;
    const auto after = applied(s, tool, limits);
    if (!after) return;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const std::uint8_t was = s.before.labels.labels[i];
      const std::uint8_t is = after->labels.labels[i];
      if (was != 0 && was != kValue) {
        EXPECT_EQ(is, was);
      }
      if (limits.only && !inRange(s.volume, i, *limits.only)) {
        EXPECT_EQ(is, was);
      }
      if (is != was) {
        EXPECT_TRUE((is == kValue && was == 0) || (is == 0 && was == kValue));
      }
    }
    limits.overOthers = true;
    const auto over = applied(s, tool, limits);
    ASSERT_TRUE(over);
    for (std::size_t i = 0; i < s.size(); ++i) {  // the same but for what others hold
      const std::uint8_t was = s.before.labels.labels[i];
      if (was == 0 || was == kValue) {
        EXPECT_EQ(over->labels.labels[i], after->labels.labels[i]);
      } else {
        EXPECT_TRUE(over->labels.labels[i] == was || over->labels.labels[i] == kValue);
      }
    }
  });
}

/// The scan with its axes in the order `from` and reversed where `flip` says.
Sample turned(const Sample& s, const std::array<int, 3>& from, const std::array<bool, 3>& flip) {
  Sample out = s;
  GridGeometry& g = out.volume.geometry;
  for (std::size_t a = 0; a < 3; ++a) {
    g.dims[a] = s.geometry().dims[static_cast<std::size_t>(from[a])];
    g.spacing[static_cast<int>(a)] = s.geometry().spacing[from[a]];
  }
  out.before.labels.geometry = g;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Voxel v = voxelOf(g, i);
    const std::array<int, 3> at{v.i, v.j, v.k};
    std::array<int, 3> source{};
    for (std::size_t a = 0; a < 3; ++a) {
      source[static_cast<std::size_t>(from[a])] = flip[a] ? g.dims[a] - 1 - at[a] : at[a];
    }
    out.before.labels.labels[i] =
        s.before.labels.labels[s.geometry().index(source[0], source[1], source[2])];
  }
  return out;
}

TEST(Smooth, TurningTheScanTurnsTheResult) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    Sample s = plainSample({13, 17, 11}, random.point(0.4, 1.1));
    for (int n = 0; n < 6; ++n) {
      const Eigen::Vector3d middle(random.real(0, 12), random.real(0, 16), random.real(0, 10));
      const double radius = random.real(2.5, 5.5);
      fill(s, [&](const Voxel& v) {
        return (Eigen::Vector3d(v.i, v.j, v.k) - middle).norm() <= radius;
      });
    }
    const tool::Smooth tool{.mm = random.real(0.4, 0.9), .keepThin = seed % 2 == 0};
    const auto plain = applied(s, tool);
    ASSERT_TRUE(plain) << sentence(plain.error());
    Sample smoothed = s;
    smoothed.before.labels = plain->labels;
    for (const auto& [from, flip] :
         {std::pair{std::array{0, 1, 2}, std::array{true, false, false}},
          std::pair{std::array{0, 1, 2}, std::array{false, true, false}},
          std::pair{std::array{0, 1, 2}, std::array{false, false, true}},
          std::pair{std::array{1, 2, 0}, std::array{false, false, false}},
          std::pair{std::array{2, 1, 0}, std::array{true, false, true}}}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", axes " + std::to_string(from[0]) +
                   std::to_string(from[1]) + std::to_string(from[2]));
      const auto after = applied(turned(s, from, flip), tool);
      ASSERT_TRUE(after);
      EXPECT_TRUE(sameLabels(turned(smoothed, from, flip).before.labels, after->labels));
      if (HasFailure()) return;
    }
  }
}

}  // namespace
}  // namespace palpate::test
