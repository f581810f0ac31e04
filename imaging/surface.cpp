#include "imaging/surface.h"

#include <tbb/parallel_for.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace palpate {
namespace {

// Gaussian of 0.7 steps over 0/1: removes the staircase of a label mask, moves a flat face by
// nothing and a corner by less than half a voxel. Two steps of reach hold 99.6 % of it.
constexpr double kSigma = 0.7;
constexpr int kReach = 2;
// Light needs more blur than shape: normals come from the field blurred once more (Gaussian of 1
// step, the two together 1.2). For shape that would swallow bone of one voxel.
constexpr double kShadingSigma = 1.0;
// Around a chunk both blurs reach out, and one more step for the gradient: so that what is computed
// at its border is bit for bit what the neighbour computes.
constexpr int kHalo = 2 * kReach + 1;
constexpr float kInside = 0.5F;

std::array<float, 2 * kReach + 1> gaussian(double sigma) {
  std::array<float, 2 * kReach + 1> weights{};
  double sum = 0.0;
  for (int i = -kReach; i <= kReach; ++i) sum += std::exp(-0.5 * i * i / (sigma * sigma));
  for (int i = -kReach; i <= kReach; ++i) {
    weights[static_cast<std::size_t>(i + kReach)] =
        static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma)) / sum);
  }
  return weights;
}

/// A small float grid, x fastest.
struct Field {
  std::array<int, 3> n{0, 0, 0};
  std::vector<float> v;
  Field() = default;
  explicit Field(std::array<int, 3> size)
      : n(size),
        v(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
          static_cast<std::size_t>(size[2])) {}
  [[nodiscard]] std::size_t at(int i, int j, int k) const {
    return static_cast<std::size_t>((k * n[1] + j) * n[0] + i);
  }
};

/// What one chunk needs of the whole: sample points first..last (inclusive), in steps.
struct ChunkSpan {
  std::array<int, 3> first{}, last{};
};

/// The samples of one axis run from -1 (outside) to the first that is outside again, so that a
/// label that touches the border of the scan is closed there.
int lastSample(int voxels, int step) {
  return (voxels - 1) / step + 1;
}

ChunkSpan spanOf(const std::array<std::int32_t, 3>& chunk, const GridGeometry& g, int step) {
  ChunkSpan span;
  const int cells = kSurfaceChunkVoxels / step;
  for (std::size_t a = 0; a < 3; ++a) {
    span.first[a] = chunk[a] * cells - 1;
    span.last[a] = std::min(span.first[a] + cells, lastSample(g.dims[a], step));
  }
  return span;
}

/// The mask in a chunk and its halo; `mixed` says whether a surface can pass.
Field maskField(const LabelGrid& grid, std::uint8_t value, const ChunkSpan& span, int step,
                bool& mixed) {
  const auto& dims = grid.geometry.dims;
  Field field({span.last[0] - span.first[0] + 1 + 2 * kHalo,
               span.last[1] - span.first[1] + 1 + 2 * kHalo,
               span.last[2] - span.first[2] + 1 + 2 * kHalo});
  std::size_t set = 0;
  for (int k = 0; k < field.n[2]; ++k) {
    const int z = (span.first[2] - kHalo + k) * step;
    if (z < 0 || z >= dims[2]) continue;
    for (int j = 0; j < field.n[1]; ++j) {
      const int y = (span.first[1] - kHalo + j) * step;
      if (y < 0 || y >= dims[1]) continue;
      const std::uint8_t* row = grid.labels.data() + grid.geometry.index(0, y, z);
      float* out = field.v.data() + field.at(0, j, k);
      for (int i = 0; i < field.n[0]; ++i) {
        const int x = (span.first[0] - kHalo + i) * step;
        if (x < 0 || x >= dims[0] || row[x] != value) continue;
        out[i] = 1.0F;
        ++set;
      }
    }
  }
  mixed = set != 0 && set != field.v.size();
  return field;
}

/// out[i] += weight · in[i + shift] for the i of a row where both are in it.
void addShifted(const float* in, float* out, int n, int shift, float weight) {
  const int from = std::max(0, -shift);
  const int to = n - std::max(0, shift);
  for (int i = from; i < to; ++i) out[i] += weight * in[i + shift];
}

/// Convolves along one axis; values outside the field count as 0, which only the outer halo sees.
/// Whole rows at a time, always in the same order of terms.
void smoothAxis(Field& field, int axis, const std::array<float, 2 * kReach + 1>& weights) {
  Field out(field.n);
  for (int k = 0; k < field.n[2]; ++k) {
    for (int j = 0; j < field.n[1]; ++j) {
      float* row = out.v.data() + out.at(0, j, k);
      for (int t = -kReach; t <= kReach; ++t) {
        const float weight = weights[static_cast<std::size_t>(t + kReach)];
        const int fromJ = axis == 1 ? j + t : j;
        const int fromK = axis == 2 ? k + t : k;
        if (fromJ < 0 || fromJ >= field.n[1] || fromK < 0 || fromK >= field.n[2]) continue;
        addShifted(field.v.data() + field.at(0, fromJ, fromK), row, field.n[0], axis == 0 ? t : 0,
                   weight);
      }
    }
  }
  field.v.swap(out.v);
}

/// Flying edges over the inner points of the field; vertices in steps from the inner first point.
vtkSmartPointer<vtkPolyData> contour(const Field& field) {
  auto image = vtkSmartPointer<vtkImageData>::New();
  const std::array<int, 3> inner{field.n[0] - 2 * kHalo, field.n[1] - 2 * kHalo,
                                 field.n[2] - 2 * kHalo};
  image->SetDimensions(inner[0], inner[1], inner[2]);
  image->AllocateScalars(VTK_FLOAT, 1);
  auto* scalars = static_cast<float*>(image->GetScalarPointer());
  for (int k = 0; k < inner[2]; ++k) {
    for (int j = 0; j < inner[1]; ++j) {
      const float* row = field.v.data() + field.at(kHalo, j + kHalo, k + kHalo);
      scalars = std::copy(row, row + inner[0], scalars);
    }
  }
  auto edges = vtkSmartPointer<vtkFlyingEdges3D>::New();
  edges->SetInputData(image);
  edges->SetValue(0, static_cast<double>(kInside));
  edges->ComputeNormalsOff();
  edges->ComputeGradientsOff();
  edges->ComputeScalarsOff();
  edges->Update();
  return edges->GetOutput();
}

/// Central difference at a point of the field, in value per step.
Eigen::Vector3f gradientAt(const Field& f, int i, int j, int k) {
  return {f.v[f.at(i + 1, j, k)] - f.v[f.at(i - 1, j, k)],
          f.v[f.at(i, j + 1, k)] - f.v[f.at(i, j - 1, k)],
          f.v[f.at(i, j, k + 1)] - f.v[f.at(i, j, k - 1)]};
}

/// A vertex lies on a grid edge: the gradient between the two ends.
Eigen::Vector3f gradientOn(const Field& f, const Eigen::Vector3f& p) {
  std::array<int, 3> low{};
  Eigen::Vector3f rest;
  for (Eigen::Index a = 0; a < 3; ++a) {
    const float floor = std::floor(p[a]);
    low[static_cast<std::size_t>(a)] = static_cast<int>(floor) + kHalo;
    rest[a] = p[a] - floor;
  }
  Eigen::Index axis = 0;
  rest.maxCoeff(&axis);
  const Eigen::Vector3f here = gradientAt(f, low[0], low[1], low[2]);
  if (rest[axis] <= 0.0F) return here;
  const Eigen::Vector3f next = gradientAt(
      f, low[0] + (axis == 0 ? 1 : 0), low[1] + (axis == 1 ? 1 : 0), low[2] + (axis == 2 ? 1 : 0));
  return here + rest[axis] * (next - here);
}

void takeVertices(vtkPolyData& mesh, const Field& field, const ChunkSpan& span,
                  const GridGeometry& g, int step, SurfaceChunk& chunk) {
  const vtkIdType count = mesh.GetNumberOfPoints();
  chunk.vertices_mm.reserve(static_cast<std::size_t>(count) * 3);
  chunk.normals.reserve(static_cast<std::size_t>(count) * 3);
  const Eigen::Matrix3d toPatient_mm = g.X_PV.linear() * (g.spacing * (1e3 * step)).asDiagonal();
  const Eigen::Vector3d origin_mm = g.X_PV.translation() * 1e3;
  const Eigen::Matrix3d normalToPatient = g.X_PV.linear() * g.spacing.cwiseInverse().asDiagonal();
  const Eigen::Vector3d first(span.first[0], span.first[1], span.first[2]);
  for (vtkIdType v = 0; v < count; ++v) {
    double local[3];
    mesh.GetPoint(v, local);
    const Eigen::Vector3d p(local[0], local[1], local[2]);
    const Eigen::Vector3d p_mm = toPatient_mm * (p + first) + origin_mm;
    // The field falls outwards.
    const Eigen::Vector3d n =
        (normalToPatient * -gradientOn(field, p.cast<float>()).cast<double>()).stableNormalized();
    for (Eigen::Index a = 0; a < 3; ++a) {
      chunk.vertices_mm.push_back(static_cast<float>(p_mm[a]));
      chunk.normals.push_back(static_cast<float>(n[a]));
    }
  }
}

void takeTriangles(vtkPolyData& mesh, SurfaceChunk& chunk) {
  vtkCellArray* cells = mesh.GetPolys();
  chunk.triangles.reserve(static_cast<std::size_t>(cells->GetNumberOfCells()) * 3);
  vtkIdType size = 0;
  const vtkIdType* ids = nullptr;
  for (cells->InitTraversal(); cells->GetNextCell(size, ids) != 0;) {
    for (vtkIdType c = 0; c < 3; ++c) chunk.triangles.push_back(static_cast<std::uint32_t>(ids[c]));
  }
}

SurfaceChunk meshSpan(const LabelGrid& labels, std::uint8_t value, int step,
                      const std::array<std::int32_t, 3>& index) {
  SurfaceChunk chunk;
  chunk.chunk = index;
  const ChunkSpan span = spanOf(index, labels.geometry, step);
  bool mixed = false;
  Field field = maskField(labels, value, span, step, mixed);
  if (!mixed) return chunk;
  static const auto shape = gaussian(kSigma);
  static const auto shading = gaussian(kShadingSigma);
  for (int axis = 0; axis < 3; ++axis) smoothAxis(field, axis, shape);
  const auto mesh = contour(field);
  if (mesh->GetNumberOfPoints() == 0) return chunk;
  for (int axis = 0; axis < 3; ++axis) smoothAxis(field, axis, shading);
  takeVertices(*mesh, field, span, labels.geometry, step, chunk);
  takeTriangles(*mesh, chunk);
  return chunk;
}

Result<void> checkMeshRequest(const LabelGrid& labels, std::uint8_t value, int step) {
  if (step != 1 && step != 2) {
    return fail(usageError("The step of a surface is 1 or 2.").butFound(std::to_string(step)));
  }
  if (value == 0 || labels.labels.empty() || labels.labels.size() != labels.geometry.voxelCount()) {
    return fail(usageError("A surface needs a label from 1 to 255 and a full label grid."));
  }
  return {};
}

}  // namespace

std::array<std::int32_t, 3> surfaceChunkCounts(const GridGeometry& geometry, int step) {
  std::array<std::int32_t, 3> counts{};
  const int cells = kSurfaceChunkVoxels / step;
  for (std::size_t a = 0; a < 3; ++a) {
    counts[a] = (lastSample(geometry.dims[a], step) + 1 + cells - 1) / cells;
  }
  return counts;
}

Result<SurfaceChunk> meshLabelChunk(const LabelGrid& labels, std::uint8_t value, int step,
                                    const std::array<std::int32_t, 3>& chunk) {
  if (auto fits = checkMeshRequest(labels, value, step); !fits) return fail(fits.error());
  const auto counts = surfaceChunkCounts(labels.geometry, step);
  for (std::size_t a = 0; a < 3; ++a) {
    if (chunk[a] < 0 || chunk[a] >= counts[a]) {
      return fail(usageError("There is no such chunk.").butFound(std::to_string(chunk[a])));
    }
  }
  return meshSpan(labels, value, step, chunk);
}

Result<std::vector<SurfaceChunk>> meshLabel(const LabelGrid& labels, std::uint8_t value, int step,
                                            const Progress& progress) {
  if (auto fits = checkMeshRequest(labels, value, step); !fits) return fail(fits.error());
  const auto counts = surfaceChunkCounts(labels.geometry, step);
  std::vector<SurfaceChunk> chunks(static_cast<std::size_t>(counts[0]) *
                                   static_cast<std::size_t>(counts[1]) *
                                   static_cast<std::size_t>(counts[2]));
  vtkSmartPointer<vtkFlyingEdges3D>::New();  // VTK's factories are filled by the first of a kind
  std::atomic<bool> stopped{false};
  // Layer by layer, so that progress is told by this thread alone.
  const std::size_t layer =
      static_cast<std::size_t>(counts[0]) * static_cast<std::size_t>(counts[1]);
  for (std::int32_t z = 0; z < counts[2]; ++z) {
    tbb::parallel_for(std::size_t{0}, layer, [&](std::size_t c) {
      if (progress.cancelled()) stopped = true;
      if (stopped) return;
      const auto x = static_cast<std::int32_t>(c) % counts[0];
      const auto y = static_cast<std::int32_t>(c) / counts[0];
      chunks[static_cast<std::size_t>(z) * layer + c] = meshSpan(labels, value, step, {x, y, z});
    });
    if (stopped) return fail(cancelled());
    progress(static_cast<double>(z + 1) / counts[2], "Meshing");
  }
  std::erase_if(chunks, [](const SurfaceChunk& c) { return c.triangles.empty(); });
  return chunks;
}

}  // namespace palpate
