#pragma once
/// What is left of a query's contacts where there are more than the budget. Internal to
/// ContactFinder.

#include <cstddef>
#include <vector>

#include "core/collision/query_work.h"
#include "core/collision/thinned_shell.h"

namespace palpate {

/// Of every node of the shell's hierarchy, at the finest level that has no more nodes with contacts
/// than the budget, the deepest contact stays (ties: the lower shell index). Contacts lie in
/// `packed` by rank or in `hits` in any order, and stay there; a pass for each level, and a sort
/// where they lie in `hits`.
void keepDeepest(QueryWork& work) noexcept;

/// The shells that are asked before the whole one, the fewest points first: a point for every node
/// of a level that has more nodes than the budget. Where already one of them has more contacts than
/// the budget, nothing finer is looked at.
[[nodiscard]] std::vector<ThinnedShell> shellsBefore(const ShellHierarchy& shell,
                                                     const ShellBlocks& blocks, std::size_t budget);

}  // namespace palpate
