#pragma once
/// Removes and adds voxels of a VoxelTree in place, exactly.
///
/// Afterwards the tree has the items, codes, labels and counts of one that is built from the edited
/// labels. What may differ:
///  - the order of nodes, bricks and words, and places that nothing links to (garbage, below);
///  - clearances, which stay lower bounds: removing leaves them as they are (the region shrinks),
///    adding lowers them by the distance to the box around what was added;
///  - bricks deeper than saturation all over, which share ramps as built, but may have codes of
///    their own after an edit (contacts there are saturated either way);
///  - labels: a tree that once had several keeps a label for each voxel.
///
/// One thread, the tree's owner, between the steps that read it: readers hold nothing that an edit
/// leaves behind but what they remember about voxels (VoxelTree::Data::edits tells).
///
/// Memory. The editor keeps two bits a voxel of the grid, and windows for 32³ voxels and the band
/// around them; an edit takes none for itself. The tree's arrays grow where nodes, bricks or bytes
/// must move; reserve() takes that memory before, for all edits within a box, however many. The
/// garbage is bounded: whatever grows moves once, to a place as large as it can ever need, which is
/// used again when it goes. So arrays never exceed their size as built by more than a tree without
/// an empty voxel would take (of the part that is edited). compact() puts them in order.
///
/// Time. Boxes of 32³ voxels that have changes are done one by one; each costs about what its
/// changes and the band around them (17.7 smallest spacings) hold. Many voxels far apart are slow.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "core/base/error.h"
#include "core/voxels/voxel_tree.h"

namespace palpate {

enum class EditStatus : std::uint8_t {
  Done,
  OutsideGrid,   ///< A voxel is not in the grid; nothing changed.
  WouldBeEmpty,  ///< No voxel would be left, which a tree cannot express; nothing changed.
  NoLabel,       ///< Label 0 is the background; nothing changed.
};

struct EditResult {
  EditStatus status = EditStatus::Done;
  std::size_t changed = 0;
  std::size_t ignored = 0;  ///< Given twice, or already as asked for.
  bool tookMemory = false;  ///< An array grew: not for real time. See reserve().
};

class TreeEditor {
 public:
  using Voxel = std::array<std::int32_t, 3>;

  /// Keeps the tree's arrays, so the tree may be moved but must outlive the editor; one editor a
  /// tree. Refuses surface-only trees, which do not know their inside, and grids so large that
  /// edits could need more places than can be linked.
  [[nodiscard]] static Result<TreeEditor> create(VoxelTree& tree);
  TreeEditor(TreeEditor&&) noexcept;
  TreeEditor& operator=(TreeEditor&&) noexcept;
  ~TreeEditor();

  /// Takes voxels away. Any order.
  EditResult remove(std::span<const Voxel> voxels);
  /// Adds voxels of one label, not 0; those that are there keep theirs. The first other label in a
  /// tree of one label takes memory and the time to label the whole tree (separateLabels()).
  EditResult add(std::span<const Voxel> voxels, std::uint8_t label);

  /// Takes the memory for all edits of voxels in [lo, hi), however many. Not for real time.
  void reserve(const Voxel& lo, const Voxel& hi);
  /// Makes a tree of one label ready for others. Call before reserve(). Not for real time.
  void separateLabels();
  /// Puts arrays in the order of a build, without garbage; memory that was reserved is given back.
  /// Not for real time.
  void compact();

 private:
  class Work;
  explicit TreeEditor(std::unique_ptr<Work> work) noexcept;
  std::unique_ptr<Work> work_;
};

}  // namespace palpate
