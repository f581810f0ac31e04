#include "imaging/regular_stack.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

// A box of more times the voxels would be made up, not repaired; and a short file must not cost the
// memory of a long one.
constexpr double kMaxGrowth = 16.0;
constexpr double kAlwaysAllowed = 1 << 16;  // A few tiny slices far apart: 40³ voxels.

/// A slice in the stack's own axes, relative to the first: across (in voxels) and along (mm).
struct SlicePlace {
  double u = 0.0, v = 0.0, along_mm = 0.0;
};

std::vector<SlicePlace> placesOf(const Volume& stack, const std::vector<Eigen::Vector3d>& p_mm) {
  std::vector<SlicePlace> places;
  for (const Eigen::Vector3d& p : p_mm) {
    const Eigen::Vector3d q = stack.geometry.X_PV.linear().transpose() * (p - p_mm.front());
    places.push_back({q.x() / (stack.geometry.spacing.x() * 1e3),
                      q.y() / (stack.geometry.spacing.y() * 1e3), q.z()});
  }
  return places;
}

double medianGap(const std::vector<SlicePlace>& places) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < places.size(); ++i) {
    gaps.push_back(places[i].along_mm - places[i - 1].along_mm);
  }
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
  std::nth_element(gaps.begin(), middle, gaps.end());
  return *middle;
}

/// One slice of the stack, read between its voxels.
class SliceSampler {
 public:
  SliceSampler(const Volume& stack, double outside) : stack_(stack), outside_(outside) {}
  [[nodiscard]] double at(std::size_t slice, double x, double y) const {
    const auto& dims = stack_.geometry.dims;
    if (x < -0.5 || y < -0.5 || x > dims[0] - 0.5 || y > dims[1] - 0.5) return outside_;
    const double cx = std::clamp(x, 0.0, static_cast<double>(dims[0] - 1));
    const double cy = std::clamp(y, 0.0, static_cast<double>(dims[1] - 1));
    const auto i = static_cast<std::int32_t>(cx);
    const auto j = static_cast<std::int32_t>(cy);
    const double fx = cx - i;
    const double fy = cy - j;
    const std::int32_t i1 = std::min(i + 1, dims[0] - 1);
    const std::int32_t j1 = std::min(j + 1, dims[1] - 1);
    const auto k = static_cast<std::int32_t>(slice);
    const auto value = [&](std::int32_t a, std::int32_t b) {
      return stack_.value(stack_.geometry.index(a, b, k));
    };
    const double low = value(i, j) + fx * (value(i1, j) - value(i, j));
    const double high = value(i, j1) + fx * (value(i1, j1) - value(i, j1));
    return low + fy * (high - low);
  }

 private:
  const Volume& stack_;
  double outside_;
};

void storeValue(Volume& volume, std::size_t index, double value) {
  if (volume.type == VoxelType::Int16) {
    volume.int16[index] = static_cast<std::int16_t>(std::lround(value));
  } else {
    volume.float32[index] = static_cast<float>(value);
  }
}

/// The box that holds every slice: how many voxels it begins before the first slice.
struct Box {
  int before_x = 0, before_y = 0;
  GridGeometry geometry;
};

Result<Box> boxOf(const Volume& stack, const std::vector<SlicePlace>& places,
                  const Eigen::Vector3d& first_mm) {
  double lowU = 0.0;
  double highU = 0.0;
  double lowV = 0.0;
  double highV = 0.0;
  for (const SlicePlace& p : places) {
    lowU = std::min(lowU, p.u);
    highU = std::max(highU, p.u);
    lowV = std::min(lowV, p.v);
    highV = std::max(highV, p.v);
  }
  const double length = places.back().along_mm;
  const double slices = std::round(length / medianGap(places)) + 1.0;
  const double nx = stack.geometry.dims[0] + std::ceil(highU - 1e-6) - std::floor(lowU + 1e-6);
  const double ny = stack.geometry.dims[1] + std::ceil(highV - 1e-6) - std::floor(lowV + 1e-6);
  const double largest = std::min(
      static_cast<double>(kMaxVoxels),
      std::max(kMaxGrowth * static_cast<double>(stack.geometry.voxelCount()), kAlwaysAllowed));
  if (!(slices >= 2.0) || !(nx * ny * slices < largest)) {
    return fail(inputRefused("The repaired volume would be larger than Palpate can hold, or more "
                             "than sixteen times the series.")
                    .advise("Choose a series with even spacing."));
  }
  Box box;
  box.before_x = static_cast<int>(-std::floor(lowU + 1e-6));
  box.before_y = static_cast<int>(-std::floor(lowV + 1e-6));
  GridGeometry& g = box.geometry;
  g = stack.geometry;
  g.dims = {static_cast<std::int32_t>(nx), static_cast<std::int32_t>(ny),
            static_cast<std::int32_t>(slices)};
  g.spacing.z() = length / (slices - 1.0) * 1e-3;
  g.X_PV.translation() =
      first_mm * 1e-3 - g.X_PV.linear() * Eigen::Vector3d(box.before_x * g.spacing.x(),
                                                          box.before_y * g.spacing.y(), 0.0);
  return box;
}

}  // namespace

Result<RegularStack> makeRegularStack(const Volume& stack,
                                      const std::vector<Eigen::Vector3d>& positions_mm,
                                      const Progress& progress) {
  const auto places = placesOf(stack, positions_mm);
  const auto box = boxOf(stack, places, positions_mm.front());
  if (!box) return fail(box.error());
  RegularStack out;
  out.volume.geometry = box->geometry;
  out.volume.type = stack.type;
  out.volume.modality = stack.modality;
  const std::size_t voxels = box->geometry.voxelCount();
  if (stack.type == VoxelType::Int16) {
    out.volume.int16.resize(voxels);
  } else {
    out.volume.float32.resize(voxels);
  }
  const double spacing_mm = box->geometry.spacing.z() * 1e3;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector3d off(places[i].u * stack.geometry.spacing.x() * 1e3,
                              places[i].v * stack.geometry.spacing.y() * 1e3,
                              places[i].along_mm - spacing_mm * static_cast<double>(i));
    out.largestDisplacement_mm = std::max(out.largestDisplacement_mm, off.norm());
  }
  const SliceSampler sampler(stack, valueRange(stack).first);
  const auto& dims = box->geometry.dims;
  for (std::int32_t k = 0; k < dims[2]; ++k) {
    if (progress.cancelled()) return fail(cancelled());
    const double along = std::min(spacing_mm * k, places.back().along_mm);
    std::size_t low = 0;
    while (low + 2 < places.size() && places[low + 1].along_mm <= along) ++low;
    const SlicePlace& a = places[low];
    const SlicePlace& b = places[low + 1];
    double weight = std::clamp((along - a.along_mm) / (b.along_mm - a.along_mm), 0.0, 1.0);
    // A plane that lies on a slice is that slice: rounding must not blend in its neighbour.
    if (weight < 1e-6) weight = 0.0;
    if (weight > 1.0 - 1e-6) weight = 1.0;
    tbb::parallel_for(std::int32_t{0}, dims[1], [&](std::int32_t j) {
      for (std::int32_t i = 0; i < dims[0]; ++i) {
        const double x = i - box->before_x;
        const double y = j - box->before_y;
        double value = 0.0;
        if (weight < 1.0) value += (1.0 - weight) * sampler.at(low, x - a.u, y - a.v);
        if (weight > 0.0) value += weight * sampler.at(low + 1, x - b.u, y - b.v);
        storeValue(out.volume, box->geometry.index(i, j, k), value);
      }
    });
    progress(static_cast<double>(k + 1) / dims[2], "Resampling to a regular grid");
  }
  return out;
}

}  // namespace palpate
