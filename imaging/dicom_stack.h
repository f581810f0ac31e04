#pragma once
/// Images of one series, orientation and size, as one stack: sorted, measured, and judged.
///
/// By position and orientation only; names of files and instance numbers mean nothing. Pure: looks
/// at headers, touches no file.

#include <cstddef>
#include <string>
#include <vector>

#include "core/geometry/grid_geometry.h"
#include "imaging/dicom_header.h"

namespace palpate {

struct FrameRef {
  std::size_t file = 0;  ///< Index into the files given.
  std::size_t frame = 0;
};

/// What a stack of slices is like, beside a regular box.
struct StackShape {
  double spacing_mm = 0.0;  ///< Mean distance along the normal.
  double minGap_mm = 0.0, maxGap_mm = 0.0;
  double tilt_deg = 0.0;       ///< Between the stack's way and the normal.
  double unevenness_mm = 0.0;  ///< Largest distance along the normal from an even spacing.
  double sideways_mm = 0.0;    ///< Largest distance across the normal from a straight stack.
  [[nodiscard]] bool tilted() const noexcept;
  [[nodiscard]] bool uneven() const noexcept;
  [[nodiscard]] std::string repairs() const;  ///< "tilt", "spacing" or both, as --repair wants it.
};

/// Images of one series, one orientation, one size: one volume, or a reason why not.
struct DicomStack {
  std::string uid;  ///< The series' UID; with "#2" where a series holds several stacks.
  bool scout = false;
  std::vector<FrameRef> slices;      ///< Ascending along row × column; one a place.
  std::vector<FrameRef> duplicates;  ///< Same place as the slice of `duplicateOf`.
  std::vector<std::size_t> duplicateOf;
  StackShape shape;
  GridGeometry geometry;     ///< Of the regular box; valid when there is no problem or needsRepair.
  DicomProblem problem;      ///< Why it is not a volume; empty when it is.
  bool needsRepair = false;  ///< `problem` speaks of tilt or uneven spacing only.
  std::vector<std::string> warnings;
};

[[nodiscard]] const DicomFrame& frameOf(const std::vector<DicomFile>& files, const FrameRef& ref);
/// Of frames that lie alike; not empty.
[[nodiscard]] DicomStack makeStack(const std::vector<DicomFile>& files,
                                   const std::vector<FrameRef>& frames);
/// The header's; "OT" (other) for a CT whose values are not Hounsfield units, so that nothing takes
/// its numbers for them.
[[nodiscard]] std::string modalityOf(const std::vector<DicomFile>& files, const DicomStack& stack);

}  // namespace palpate
