#include "core/voxels/voxel_tree.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "core/voxels/leaf_codes.h"
#include "core/voxels/tree_topology.h"
#include "core/voxels/voxel_bits.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {
namespace {

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
  const double ratio = g.spacing.maxCoeff() / g.spacing.minCoeff();
  if (ratio > kMaxSpacingRatio) {
    return fail(inputRefused("The voxels are too long for their width.")
                    .inField("spacing")
                    .butFound("1 to " + std::to_string(ratio))
                    .wants("at most 1 to 1000")
                    .advise("Resample the volume to a more even spacing."));
  }
  if (grid.labels.size() != g.voxelCount()) {
    return fail(inputRefused("The label volume does not hold as many labels as voxels.")
                    .inField("labels")
                    .butFound(std::to_string(grid.labels.size()))
                    .wants(std::to_string(g.voxelCount())));
  }
  return {};
}

Result<VoxelBits> selectVoxels(const LabelGrid& grid, std::span<const std::uint8_t> labels) {
  std::array<std::uint8_t, 256> wanted{};
  for (const std::uint8_t label : labels) wanted[label] = 1;
  if (labels.empty()) wanted.fill(1);
  wanted[0] = 0;  // background is never solid
  VoxelBits solid = packBits(grid.geometry.dims, grid.labels, wanted);
  if (std::all_of(solid.word.begin(), solid.word.end(), [](auto w) { return w == 0; })) {
    return fail(inputRefused("No voxel of the label volume is selected, so there is no tree.")
                    .inField("labels")
                    .advise("Segment the structure first, or choose a label that has voxels."));
  }
  return solid;
}

void fillStats(VoxelTree::Data& data) {
  TreeStats& stats = data.stats;
  stats.levels = data.levels;
  const std::size_t maskBytes = (std::size_t{1} << (3 * data.bits)) / 8;
  for (std::size_t l = 1; l < data.level.size(); ++l) {
    stats.nodesPerLevel.push_back(data.level[l].masks.size() / maskBytes);
  }
  countBytes(data);
}

}  // namespace

// Links between nodes are topology; level 1 has none, it links to what its leaves carry.
void countBytes(VoxelTree::Data& data) noexcept {
  data.stats.topologyBytes = 0;
  for (std::size_t l = 1; l < data.level.size(); ++l) {
    data.stats.topologyBytes +=
        data.level[l].masks.bytes() + (l > 1 ? data.level[l].firstChild.bytes() : 0);
  }
  data.stats.payloadBytes =
      data.level[1].firstChild.bytes() + data.leafBytes.bytes() + data.depth.bytes();
}

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
  const VoxelBits surface = surfaceOf(*solid);
  data->stats.surfaceVoxels = surface.count();
  data->stats.solidVoxels = solid->count();

  progress(0.15, "Building the tree");
  const bool distance = options.leaf == LeafModel::Distance;
  VoxelBits items = options.surfaceOnly ? surface : *solid;
  if (distance) items = cellsOf(items);
  data->extent = items.extent;
  data->origin =
      distance ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(-0.5 * grid.geometry.spacing);
  auto topology = buildTopology(data->bits, items);
  if (!topology) return fail(topology.error());
  if (progress.cancelled()) return fail(cancelled());
  data->levels = topology->levels;

  if (distance) {
    topology->level[1].firstChild = {};  // cells carry nothing of their own
    auto depth = buildDepthBricks(grid, *solid, items, progress);
    if (!depth) return fail(depth.error());
    data->depth = std::move(*depth);
  } else {
    data->depth.palette = DepthPalette(grid.geometry.spacing);
    data->depth.uniformLabel = onlyLabelOf(grid, *solid);
    if (auto ok = fillLeaves(grid, *solid, data->depth.palette, data->depth.uniformLabel,
                             data->bits, options.surfaceOnly, *topology, data->leafBytes, progress);
        !ok) {
      return fail(ok.error());
    }
  }
  progress(0.95, "Putting the tree together");
  data->level = std::move(topology->level);
  if (progress.cancelled()) return fail(cancelled());
  fillStats(*data);
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  data->stats.buildMs = took.count();
  progress(1.0, "Tree built");
  return data;
}

}  // namespace palpate
