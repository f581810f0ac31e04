#pragma once
/// One axis of the separable transform of signed squared distances: along x from bits, along y and
/// z from what the axis before left (banded_distance.h says what the values are).
///
/// Shared by the build, slab by slab, and by edits, in windows, so that both give the same bits.
/// Takes no memory; any thread.

#include <cstddef>
#include <cstdint>

namespace palpate {

/// Where a row begins and ends, in voxels: [from, to) is looked at, [first, last) is asked for.
struct RowSpan {
  std::int32_t from = 0, to = 0, first = 0, last = 0;
};
/// How far to measure, as squares; beyond, values only say so.
struct SquareCaps {
  float far = 0, deep = 0;  ///< Outside, inside.
};

/// Along a row of bits: a voxel's distance is that to the nearer end of its run, if that lies
/// within what is looked at. out[0] is voxel `first`. True where all are of one kind.
bool squaresAlongRow(const std::uint64_t* bits, const RowSpan& row, float weight,
                     const SquareCaps& caps, float* out) noexcept;

/// Along another axis: `n` rows of `width` values in, rows first .. last − 1 out; `width` and the
/// strides are multiples of 16, the arrays aligned to 64 bytes. `weight` is the square of a step.
void refineRows(const float* in, std::size_t inStride, std::size_t n, float* out,
                std::size_t outStride, std::size_t first, std::size_t last, std::size_t width,
                float weight);

}  // namespace palpate
