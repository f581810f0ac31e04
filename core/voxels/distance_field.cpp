#include "core/voxels/distance_field.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();
constexpr std::size_t kTile = 16;  // columns worked on together: one cache line of floats

struct Grid {
  std::size_t nx, ny, nz;
  double ax, ay, az;  // spacing / smallest spacing: squared distances stay near 1
};

// Lower envelope of the parabolas f[q] + (a·(x − q))² for one line; scratch owned by the thread.
class Envelope {
 public:
  explicit Envelope(std::size_t n) : vertex_(n), height_(n), from_(n) {}

  // In place on n values, `stride` floats apart.
  void transform(float* line, std::size_t n, std::size_t stride, double a) {
    std::size_t count = 0;
    const double a2 = a * a;
    for (std::size_t q = 0; q < n; ++q) {
      const float f = line[q * stride];
      if (f == kInfinite) continue;
      const auto x = static_cast<double>(q);
      const double h = static_cast<double>(f) + a2 * x * x;
      double start = -std::numeric_limits<double>::infinity();
      while (count > 0) {
        start = (h - height_[count - 1]) / (2.0 * a2 * (x - vertex_[count - 1]));
        if (start > from_[count - 1]) break;
        --count;
      }
      if (count == 0) start = -std::numeric_limits<double>::infinity();
      vertex_[count] = x;
      height_[count] = h;
      from_[count] = start;
      ++count;
    }
    if (count == 0) return;  // all infinite
    // Heights hold f + a²·v²; the value at x is a²·(x − v)² + f.
    std::size_t k = 0;
    for (std::size_t q = 0; q < n; ++q) {
      const auto x = static_cast<double>(q);
      while (k + 1 < count && from_[k + 1] < x) ++k;
      const double v = vertex_[k];
      const double f = height_[k] - a2 * v * v;
      const double value = a2 * (x - v) * (x - v) + std::max(f, 0.0);
      line[q * stride] = static_cast<float>(value);
    }
  }

 private:
  std::vector<double> vertex_, height_, from_;
};

// Along x the sites are the voxels themselves: two sweeps.
void transformRow(const std::uint8_t* solid, bool toSolid, float* row, std::size_t n, double a) {
  const auto squared = [a](std::size_t steps) {
    const double d = a * static_cast<double>(steps);
    return static_cast<float>(d * d);
  };
  std::size_t steps = 0;
  bool seen = false;
  for (std::size_t i = 0; i < n; ++i) {
    if ((solid[i] != 0) == toSolid) {
      seen = true;
      steps = 0;
    } else {
      ++steps;
    }
    row[i] = seen ? squared(steps) : kInfinite;
  }
  seen = false;
  for (std::size_t i = n; i-- > 0;) {
    if ((solid[i] != 0) == toSolid) {
      seen = true;
      steps = 0;
    } else {
      ++steps;
    }
    if (seen) row[i] = std::min(row[i], squared(steps));
  }
}

// Columns are copied into tiles, so that each line is contiguous in the cache while it is worked.
void transformColumns(float* first, std::size_t columns, std::size_t n, std::size_t stride,
                      double a, Envelope& envelope, std::vector<float>& tile) {
  for (std::size_t x0 = 0; x0 < columns; x0 += kTile) {
    const std::size_t width = std::min(kTile, columns - x0);
    for (std::size_t q = 0; q < n; ++q) {
      std::copy_n(first + q * stride + x0, width, tile.data() + q * kTile);
    }
    for (std::size_t c = 0; c < width; ++c) envelope.transform(tile.data() + c, n, kTile, a);
    for (std::size_t q = 0; q < n; ++q) {
      std::copy_n(tile.data() + q * kTile, width, first + q * stride + x0);
    }
  }
}

// Squared distance, in smallest spacings, from every voxel to the nearest of one kind.
bool squaredDistance(const Grid& g, std::span<const std::uint8_t> solid, bool toSolid,
                     std::vector<float>& field, const Progress& progress) {
  const std::size_t slice = g.nx * g.ny;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, g.nz), [&](const auto& range) {
    Envelope envelope(g.ny);
    std::vector<float> tile(g.ny * kTile);
    for (std::size_t z = range.begin(); z != range.end() && !progress.cancelled(); ++z) {
      for (std::size_t y = 0; y < g.ny; ++y) {
        const std::size_t row = z * slice + y * g.nx;
        transformRow(solid.data() + row, toSolid, field.data() + row, g.nx, g.ax);
      }
      transformColumns(field.data() + z * slice, g.nx, g.ny, g.nx, g.ay, envelope, tile);
    }
  });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, g.ny), [&](const auto& range) {
    Envelope envelope(g.nz);
    std::vector<float> tile(g.nz * kTile);
    for (std::size_t y = range.begin(); y != range.end() && !progress.cancelled(); ++y) {
      transformColumns(field.data() + y * g.nx, g.nx, g.nz, slice, g.az, envelope, tile);
    }
  });
  return !progress.cancelled();
}

}  // namespace

Result<std::vector<float>> signedDistanceField(const GridGeometry& geometry,
                                               std::span<const std::uint8_t> solid,
                                               const Progress& progress) {
  const double s = geometry.spacing.minCoeff();
  const Grid grid{static_cast<std::size_t>(geometry.dims[0]),
                  static_cast<std::size_t>(geometry.dims[1]),
                  static_cast<std::size_t>(geometry.dims[2]),
                  geometry.spacing.x() / s,
                  geometry.spacing.y() / s,
                  geometry.spacing.z() / s};
  const std::size_t count = geometry.voxelCount();
  double diagonal2 = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double edge = geometry.spacing[axis] * geometry.dims[static_cast<std::size_t>(axis)];
    diagonal2 += edge * edge;
  }
  const double none = std::sqrt(diagonal2);
  const auto reach = [s, none](float squared) {
    if (squared == kInfinite) return none;
    return s * std::sqrt(static_cast<double>(squared)) - 0.5 * s;
  };
  std::vector<float> field(count);
  std::vector<float> squared(count);
  for (const bool inside : {true, false}) {
    if (!squaredDistance(grid, solid, !inside, squared, progress)) return fail(cancelled());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        if ((solid[i] != 0) != inside) continue;
        field[i] = static_cast<float>(inside ? -reach(squared[i]) : reach(squared[i]));
      }
    });
  }
  return field;
}

}  // namespace palpate
