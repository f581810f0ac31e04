#include "core/voxels/voxel_tree.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "core/voxels/distance_field.h"
#include "core/voxels/leaf_payload.h"
#include "core/voxels/surface_descriptor.h"
#include "core/voxels/tree_topology.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {
namespace {

using Flags = std::vector<std::uint8_t>;

int bitsOf(Branching branching) {
  switch (branching) {
    case Branching::Children8:
      return 1;
    case Branching::Children64:
      return 2;
    case Branching::Children512:
      return 3;
  }
  return 2;
}

Result<void> checkGrid(const LabelGrid& grid) {
  const GridGeometry& g = grid.geometry;
  constexpr const char* kAxis[3] = {"x", "y", "z"};
  for (std::size_t a = 0; a < 3; ++a) {
    if (g.dims[a] < 2) {
      return fail(inputRefused(std::string("The label volume has fewer than two voxels along ") +
                               kAxis[a] + ".")
                      .inField("dims")
                      .butFound(std::to_string(g.dims[a]))
                      .wants("at least 2")
                      .advise("Import a volume with at least two slices, rows and columns."));
    }
    const double s = g.spacing[static_cast<Eigen::Index>(a)];
    if (!std::isfinite(s) || s <= 0.0) {
      return fail(inputRefused(std::string("The voxel spacing along ") + kAxis[a] +
                               " is not a positive length.")
                      .inField("spacing")
                      .butFound(std::to_string(s))
                      .wants("a finite number above 0"));
    }
  }
  if (grid.labels.size() != g.voxelCount()) {
    return fail(inputRefused("The label volume does not hold as many labels as voxels.")
                    .inField("labels")
                    .butFound(std::to_string(grid.labels.size()))
                    .wants(std::to_string(g.voxelCount())));
  }
  return {};
}

Result<Flags> selectVoxels(const LabelGrid& grid, std::span<const std::uint8_t> labels) {
  std::array<std::uint8_t, 256> wanted{};
  for (const std::uint8_t label : labels) wanted[label] = 1;
  if (labels.empty()) wanted.fill(1);
  wanted[0] = 0;  // background is never solid
  Flags solid(grid.labels.size());
  bool any = false;
  for (std::size_t i = 0; i < solid.size(); ++i) {
    solid[i] = wanted[grid.labels[i]];
    any = any || solid[i] != 0;
  }
  if (!any) {
    return fail(inputRefused("No voxel of the label volume is selected, so there is no tree.")
                    .inField("labels")
                    .advise("Segment the structure first, or choose a label that has voxels."));
  }
  return solid;
}

// Distance leaves: the cell after each voxel is present where one of its eight corners is.
Flags cellsOf(const GridGeometry& g, const Flags& corners) {
  const std::array<std::int32_t, 3> extent{g.dims[0] - 1, g.dims[1] - 1, g.dims[2] - 1};
  const auto nx = static_cast<std::size_t>(g.dims[0]);
  const std::size_t slice = nx * static_cast<std::size_t>(g.dims[1]);
  const auto ex = static_cast<std::size_t>(extent[0]);
  Flags cells(ex * static_cast<std::size_t>(extent[1]) * static_cast<std::size_t>(extent[2]));
  tbb::parallel_for(tbb::blocked_range<std::int32_t>(0, extent[2]), [&](const auto& range) {
    for (std::int32_t k = range.begin(); k != range.end(); ++k) {
      for (std::int32_t j = 0; j < extent[1]; ++j) {
        const std::uint8_t* c = corners.data() + g.index(0, j, k);
        std::uint8_t* out =
            cells.data() + (static_cast<std::size_t>(k) * static_cast<std::size_t>(extent[1]) +
                            static_cast<std::size_t>(j)) *
                               ex;
        for (std::size_t i = 0; i < ex; ++i) {
          out[i] = static_cast<std::uint8_t>(c[i] | c[i + 1] | c[i + nx] | c[i + nx + 1] |
                                             c[i + slice] | c[i + slice + 1] | c[i + slice + nx] |
                                             c[i + slice + nx + 1]);
        }
      }
    }
  });
  return cells;
}

template <class T>
std::size_t bytesOf(const std::vector<T>& v) {
  return v.size() * sizeof(T);
}

void fillStats(VoxelTree::Data& data) {
  TreeStats& stats = data.stats;
  stats.levels = data.levels;
  const std::size_t maskBytes = (std::size_t{1} << (3 * data.bits)) / 8;
  for (std::size_t l = 1; l < data.level.size(); ++l) {
    stats.nodesPerLevel.push_back(data.level[l].masks.size() / maskBytes);
    stats.topologyBytes += bytesOf(data.level[l].masks) + bytesOf(data.level[l].firstChild);
  }
  stats.payloadBytes = bytesOf(data.leafLabel) + bytesOf(data.leafNormal) +
                       bytesOf(data.leafDepth) + bytesOf(data.brick) + bytesOf(data.brickLabel);
}

}  // namespace

VoxelTree::VoxelTree(std::unique_ptr<Data> data) noexcept : data_(std::move(data)) {}
VoxelTree::VoxelTree(VoxelTree&&) noexcept = default;
VoxelTree& VoxelTree::operator=(VoxelTree&&) noexcept = default;
VoxelTree::~VoxelTree() = default;

VoxelTree VoxelTree::adopt(std::unique_ptr<Data> data) noexcept {
  return VoxelTree(std::move(data));
}

const GridGeometry& VoxelTree::geometry() const noexcept {
  return data_->geometry;
}
const TreeOptions& VoxelTree::options() const noexcept {
  return data_->options;
}
const TreeStats& VoxelTree::stats() const noexcept {
  return data_->stats;
}

Result<VoxelTree> VoxelTree::build(const LabelGrid& grid, std::span<const std::uint8_t> labels,
                                   const TreeOptions& options, const Progress& progress) {
  tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
  auto data = arena.execute([&] { return buildData(grid, labels, options, progress); });
  if (!data) return fail(data.error());
  return VoxelTree(std::move(*data));
}

Result<std::unique_ptr<VoxelTree::Data>> VoxelTree::buildData(const LabelGrid& grid,
                                                              std::span<const std::uint8_t> labels,
                                                              const TreeOptions& options,
                                                              const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  if (auto ok = checkGrid(grid); !ok) return fail(ok.error());
  auto solid = selectVoxels(grid, labels);
  if (!solid) return fail(solid.error());

  progress(0.05, "Finding the surface");
  auto data = std::make_unique<Data>();
  data->geometry = grid.geometry;
  data->options = options;
  data->bits = bitsOf(options.branching);
  data->spheres = SphereTable(data->bits, grid.geometry.spacing);
  const auto kind = classifySurface(grid.geometry, *solid);
  Flags present(solid->size());
  for (std::size_t i = 0; i < kind.size(); ++i) {
    const bool surface = kind[i] == SurfaceDescriptor::Surface;
    data->stats.surfaceVoxels += surface ? 1 : 0;
    data->stats.solidVoxels += (*solid)[i];
    present[i] = options.surfaceOnly ? static_cast<std::uint8_t>(surface) : (*solid)[i];
  }

  progress(0.15, "Measuring distances");
  const auto field = signedDistanceField(grid.geometry, *solid, progress);
  if (!field) return fail(field.error());

  progress(0.7, "Building the tree");
  data->extent = grid.geometry.dims;
  data->origin = -0.5 * grid.geometry.spacing;
  if (options.leaf == LeafModel::Distance) {
    present = cellsOf(grid.geometry, present);
    for (auto& e : data->extent) --e;
    data->origin = Eigen::Vector3d::Zero();
  }
  auto topology = buildTopology(data->bits, data->extent, present);
  if (!topology) return fail(topology.error());
  if (progress.cancelled()) return fail(cancelled());
  data->levels = topology->levels;
  data->level = std::move(topology->level);

  progress(0.85, "Storing normals and depths");
  if (options.leaf == LeafModel::Distance) {
    data->level[1].firstChild = {};  // cells carry nothing of their own
    fillBricks(grid, *solid, *field, *topology, *data);
  } else {
    fillVoxelPayload(grid, *field, *topology, *data);
  }
  if (progress.cancelled()) return fail(cancelled());
  fillStats(*data);
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  data->stats.buildMs = took.count();
  progress(1.0, "Tree built");
  return data;
}

}  // namespace palpate
