#include "imaging/components.h"

#include <algorithm>

#include "core/base/disjoint_sets.h"

namespace palpate {
namespace {

/// The runs, and where each row's begin (one entry more than rows).
void collectRuns(const std::vector<std::uint8_t>& mask, std::int32_t nx, std::size_t rows,
                 PartsOf of, std::vector<MaskRun>& runs, std::vector<std::uint32_t>& rowStart) {
  const auto meant = [of](std::uint8_t voxel) { return ((voxel & of.bits) != 0) != of.clear; };
  rowStart.reserve(rows + 1);
  for (std::size_t row = 0; row < rows; ++row) {
    rowStart.push_back(static_cast<std::uint32_t>(runs.size()));
    const std::uint8_t* voxels = mask.data() + row * static_cast<std::size_t>(nx);
    for (std::int32_t x = 0; x < nx; ++x) {
      if (!meant(voxels[x])) continue;
      MaskRun run;
      run.first = x;
      while (x + 1 < nx && meant(voxels[x + 1])) ++x;
      run.last = x;
      run.row = static_cast<std::uint32_t>(row);
      runs.push_back(run);
    }
  }
  rowStart.push_back(static_cast<std::uint32_t>(runs.size()));
}

/// Joins the touching runs of two rows; `reach` 1: corners touch too.
void joinRows(const std::vector<MaskRun>& runs, std::uint32_t a, std::uint32_t aEnd,
              std::uint32_t b, std::uint32_t bEnd, std::int32_t reach, DisjointSets& sets) {
  while (a < aEnd && b < bEnd) {
    if (runs[a].first <= runs[b].last + reach && runs[b].first <= runs[a].last + reach) {
      sets.join(a, b);
    }
    if (runs[a].last < runs[b].last) {
      ++a;
    } else {
      ++b;
    }
  }
}

}  // namespace

MaskParts findParts(const std::vector<std::uint8_t>& mask, const std::array<std::int32_t, 3>& dims,
                    PartsOf of) {
  const bool corners = of.connectivity == Connectivity::Corners;
  const auto ny = static_cast<std::size_t>(dims[1]);
  const auto nz = static_cast<std::size_t>(dims[2]);
  MaskParts parts;
  std::vector<std::uint32_t> rowStart;
  collectRuns(mask, dims[0], ny * nz, of, parts.runs, rowStart);
  DisjointSets sets(parts.runs.size());
  const auto join = [&](std::size_t row, std::size_t other) {
    joinRows(parts.runs, rowStart[row], rowStart[row + 1], rowStart[other], rowStart[other + 1],
             corners ? 1 : 0, sets);
  };
  for (std::size_t z = 0; z < nz; ++z) {
    for (std::size_t y = 0; y < ny; ++y) {
      const std::size_t row = z * ny + y;
      if (y > 0) join(row, row - 1);
      if (z == 0) continue;
      if (corners && y > 0) join(row, row - ny - 1);
      join(row, row - ny);
      if (corners && y + 1 < ny) join(row, row - ny + 1);
    }
  }
  std::vector<std::uint32_t> numberOf(parts.runs.size());
  for (std::uint32_t r = 0; r < parts.runs.size(); ++r) {
    const std::uint32_t root = sets.root(r);
    if (root == r) {
      numberOf[r] = static_cast<std::uint32_t>(parts.voxels.size());
      parts.voxels.push_back(0);
    }
    parts.runs[r].part = numberOf[root];
    parts.voxels[numberOf[root]] +=
        static_cast<std::uint64_t>(parts.runs[r].last - parts.runs[r].first + 1);
  }
  return parts;
}

std::optional<std::uint32_t> partAt(const MaskParts& parts, std::uint32_t row, std::int32_t x) {
  const auto run = std::partition_point(
      parts.runs.begin(), parts.runs.end(), [row, x](const MaskRun& candidate) {
        return candidate.row < row || (candidate.row == row && candidate.last < x);
      });
  if (run == parts.runs.end() || run->row != row || run->first > x) return std::nullopt;
  return run->part;
}

void fillParts(const MaskParts& parts, const std::vector<bool>& chosen, std::uint8_t value,
               std::int32_t nx, std::vector<std::uint8_t>& mask) {
  for (const MaskRun& run : parts.runs) {
    if (!chosen[run.part]) continue;
    const auto row = mask.begin() + static_cast<std::ptrdiff_t>(run.row) * nx;
    std::fill(row + run.first, row + run.last + 1, value);
  }
}

}  // namespace palpate
