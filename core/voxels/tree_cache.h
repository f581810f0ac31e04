#pragma once
/// A built tree in a file, so that a case opens without building again.
///
/// Layout: a header (magic, version, byte order, fingerprint of the source, length and XXH3
/// checksum of the rest), then the arrays, each after its length and aligned. A file is mapped, not
/// copied, and private: the tree may be edited, the file stays. A file is never trusted: what is
/// foreign, of another version, cut short, damaged, made from other labels or inconsistent in its
/// links is refused, and the caller builds the tree anew. Not for the loops.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/voxels/voxel_tree.h"

namespace palpate {

/// Tells one source from another: labels, geometry and selection, in 64 bits.
[[nodiscard]] std::uint64_t treeSourceFingerprint(const LabelGrid& grid,
                                                  std::span<const std::uint8_t> labels,
                                                  const TreeOptions& options);

/// The file's bytes; treeFromCache() of them gives the same tree, bit for bit.
[[nodiscard]] std::string treeToCache(const VoxelTree& tree, std::uint64_t source);
/// Refuses (InputRefused) whatever is not exactly that.
[[nodiscard]] Result<VoxelTree> treeFromCache(std::string_view bytes, std::uint64_t source);

/// Whole or not at all.
[[nodiscard]] Result<void> saveTreeCache(const VoxelTree& tree, std::uint64_t source,
                                         const std::filesystem::path& file);
[[nodiscard]] Result<VoxelTree> loadTreeCache(const std::filesystem::path& file,
                                              std::uint64_t source);

/// The name of a source's cache file in a case's folder.
[[nodiscard]] std::string treeCacheName(std::uint64_t source);

/// The tree from its cache file in `folder`, or built and left there for the next time. A file that
/// is refused is replaced; of several only the newest few stay. Where nothing can be written, or
/// with an empty `folder`, the tree is simply built. Errors and progress as VoxelTree::build.
[[nodiscard]] Result<VoxelTree> openOrBuildTree(const LabelGrid& grid,
                                                std::span<const std::uint8_t> labels,
                                                const TreeOptions& options,
                                                const std::filesystem::path& folder,
                                                const Progress& progress = {});

}  // namespace palpate
