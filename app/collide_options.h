#pragma once
/// The `--option K=V` of `palpate collide`.

#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/collision/contact_finder.h"
#include "core/voxels/voxel_tree.h"

namespace palpate {

/// Keys: surface_only, tight_spheres, one_child_skip, side_offset, coherence (on/off), stop_level,
/// contact_budget (whole numbers), perceptual_mm (0 to 100). Unknown keys and values are usage
/// errors that list what is known; a later option wins.
[[nodiscard]] Result<void> applyCollideOptions(const std::vector<std::string>& options,
                                               TreeOptions& tree, QueryOptions& query);

}  // namespace palpate
