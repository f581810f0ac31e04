#include "imaging/segment/packed_labels.h"

#include <zlib.h>

#include <exception>

namespace palpate {

PackedLabels::PackedLabels(const LabelGrid& labels)
    : geometry_(labels.geometry), voxels_(labels.labels.size()) {
  uLongf size = compressBound(voxels_);
  packed_.resize(size);
  if (compress2(packed_.data(), &size, labels.labels.data(), voxels_, Z_BEST_SPEED) != Z_OK) {
    std::terminate();  // neither memory nor space can be short: the bound is zlib's own
  }
  packed_.resize(size);
  packed_.shrink_to_fit();
}

LabelGrid PackedLabels::unpack() const {
  LabelGrid labels;
  labels.geometry = geometry_;
  if (voxels_ == 0) return labels;
  labels.labels.resize(voxels_);
  uLongf size = voxels_;
  if (uncompress(labels.labels.data(), &size, packed_.data(), packed_.size()) != Z_OK ||
      size != voxels_) {
    std::terminate();  // what we packed ourselves was changed in memory
  }
  return labels;
}

}  // namespace palpate
