#include "imaging/segment/packed_labels.h"

#include <zlib.h>

#include <algorithm>
#include <exception>
#include <memory>

namespace palpate {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 22U;  // voxels between two looks at Cancel

using End = int (*)(z_stream*);
using Stream = std::unique_ptr<z_stream, End>;

}  // namespace

Result<PackedLabels> PackedLabels::pack(const LabelGrid& labels, const Progress& progress) {
  PackedLabels packed;
  packed.geometry_ = labels.geometry;
  packed.voxels_ = labels.labels.size();
  z_stream state{};
  if (deflateInit(&state, Z_BEST_SPEED) != Z_OK) std::terminate();  // no memory for its tables
  const Stream stream(&state, deflateEnd);
  std::vector<std::uint8_t>& out = packed.packed_;
  out.resize(std::min<std::size_t>(compressBound(packed.voxels_), 1U << 16U));
  for (std::size_t at = 0;;) {
    if (progress.cancelled()) return fail(cancelled());
    progress(static_cast<double>(at) / static_cast<double>(packed.voxels_ + 1), "Keeping the undo");
    const std::size_t piece = std::min(kPiece, packed.voxels_ - at);
    state.next_in = const_cast<Bytef*>(labels.labels.data() + at);  // zlib only reads it
    state.avail_in = static_cast<uInt>(piece);
    at += piece;
    const int flush = at == packed.voxels_ ? Z_FINISH : Z_NO_FLUSH;
    int said = Z_OK;
    do {
      if (state.total_out == out.size()) out.resize(out.size() + out.size() / 2 + 64);
      state.next_out = out.data() + state.total_out;
      state.avail_out = static_cast<uInt>(out.size() - state.total_out);
      said = deflate(&state, flush);
    } while (state.avail_out == 0 || (flush == Z_FINISH && said == Z_OK));
    if (flush == Z_FINISH) break;
  }
  out.resize(state.total_out);
  out.shrink_to_fit();
  return packed;
}

Result<LabelGrid> PackedLabels::unpack(const Progress& progress) const {
  LabelGrid labels;
  labels.geometry = geometry_;
  if (voxels_ == 0) return labels;
  labels.labels.resize(voxels_);
  z_stream state{};
  if (inflateInit(&state) != Z_OK) std::terminate();  // no memory for its tables
  const Stream stream(&state, inflateEnd);
  state.next_in = const_cast<Bytef*>(packed_.data());  // zlib only reads it
  state.avail_in = static_cast<uInt>(packed_.size());
  int said = Z_OK;
  while (said == Z_OK && state.total_out < voxels_) {
    if (progress.cancelled()) return fail(cancelled());
    progress(static_cast<double>(state.total_out) / static_cast<double>(voxels_),
             "Taking the labels back");
    state.next_out = labels.labels.data() + state.total_out;
    state.avail_out = static_cast<uInt>(std::min(kPiece, voxels_ - state.total_out));
    said = inflate(&state, Z_NO_FLUSH);
  }
  if ((said != Z_OK && said != Z_STREAM_END) || state.total_out != voxels_) {
    std::terminate();  // what we packed ourselves was changed in memory
  }
  return labels;
}

}  // namespace palpate
