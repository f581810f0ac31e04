#pragma once
/// Where a NIfTI-1 file says its voxels are.
///
/// ITK chooses between sform and qform by rules that changed between its versions; here the rule is
/// fixed: sform when its code is positive, else qform when its code is positive, else the spacing
/// alone (NIfTI-1 standard, methods 3, 2 and 1), turned from RAS to LPS and to millimetres.

#include "imaging/rigid_geometry.h"

namespace palpate {

struct NiftiPlacement {
  FoundAffine affine;
  const char* field = "sform";  ///< Which part of the header gave it.
  bool inPatient = true;        ///< False for method 1: left and right are not known.
};

/// Refuses NIfTI-2, unreadable headers, and header and image in separate files.
[[nodiscard]] Result<NiftiPlacement> readNiftiPlacement(const std::filesystem::path& file);

}  // namespace palpate
