#pragma once
/// The implicit sphere tree: a label volume as a pointerless N-tree.
///
/// Source: Ruffaldi et al., "Voxel-Based Haptic Rendering Using Implicit Sphere Trees", 2008,
/// section 3.1, with the errata of the design. A node is its occupancy mask and where its children
/// begin; level, centre and bounding sphere are computed on the way down; the root carries the
/// level. Frame V of the label grid; metres. Any thread may read it, but not while a TreeEditor
/// (tree_editor.h), the only thing that changes it, is at work.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/voxels/label_grid.h"

namespace palpate {

enum class Branching : std::uint16_t { Children8 = 8, Children64 = 64, Children512 = 512 };

/// Which voxels count as touched, how deep, and which way is out (design: "A contact").
enum class LeafModel : std::uint8_t { Voxel, Distance };

struct TreeOptions {
  Branching branching = Branching::Children64;
  LeafModel leaf = LeafModel::Distance;
  bool surfaceOnly = false;  ///< Only surface voxels: misses most contacts of a pressed-in tool.
  int threads = 0;           ///< Of the build; 0: all of the machine. Never changes the result.
};

struct TreeStats {
  int levels = 0;                          ///< Level of the root; leaves are level 0.
  std::vector<std::size_t> nodesPerLevel;  ///< [0] = level 1 ... back() = root.
  std::size_t surfaceVoxels = 0;
  std::size_t solidVoxels = 0;
  std::size_t topologyBytes = 0;  ///< Masks and links between nodes.
  std::size_t payloadBytes = 0;   ///< Depths, labels, clearances, and the links to them.
  double buildMs = 0.0;
};

class VoxelTree {
 public:
  /// Builds from every voxel whose label is in `labels` (all non-zero voxels when empty).
  /// Refuses an empty selection and a grid with fewer than two voxels along any axis.
  [[nodiscard]] static Result<VoxelTree> build(const LabelGrid& grid,
                                               std::span<const std::uint8_t> labels,
                                               const TreeOptions& options,
                                               const Progress& progress = {});
  VoxelTree(VoxelTree&&) noexcept;
  VoxelTree& operator=(VoxelTree&&) noexcept;
  ~VoxelTree();

  [[nodiscard]] const GridGeometry& geometry() const noexcept;
  [[nodiscard]] const TreeOptions& options() const noexcept;
  [[nodiscard]] const TreeStats& stats() const noexcept;

  struct Data;  ///< The arrays themselves, for core/collision: core/voxels/voxel_tree_data.h.
  /// For the cache file's reader, which has checked that the arrays fit each other.
  [[nodiscard]] static VoxelTree adopt(std::unique_ptr<Data> data) noexcept;

  [[nodiscard]] const Data& data() const noexcept { return *data_; }

 private:
  friend class TreeEditor;  // changes the arrays in place
  explicit VoxelTree(std::unique_ptr<Data> data) noexcept;
  [[nodiscard]] static Result<std::unique_ptr<Data>> buildData(const LabelGrid& grid,
                                                               std::span<const std::uint8_t> labels,
                                                               const TreeOptions& options,
                                                               const Progress& progress);
  std::unique_ptr<Data> data_;
};

}  // namespace palpate
