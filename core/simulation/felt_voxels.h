#pragma once
/// A pass over the voxels that are felt.

#include <cstddef>
#include <cstdint>

#include "core/simulation/approach.h"
#include "core/voxels/label_grid.h"

namespace palpate {

/// Calls f(linear index, i, j, k) for each, x fastest.
template <class F>
void forEachFelt(const LabelGrid& grid, const FeltLabels& felt, F&& f) {
  std::size_t at = 0;
  for (std::int32_t k = 0; k < grid.geometry.dims[2]; ++k) {
    for (std::int32_t j = 0; j < grid.geometry.dims[1]; ++j) {
      for (std::int32_t i = 0; i < grid.geometry.dims[0]; ++i, ++at) {
        if (felt[grid.labels[at]]) f(at, i, j, k);
      }
    }
  }
}

}  // namespace palpate
