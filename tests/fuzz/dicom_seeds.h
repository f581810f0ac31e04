#pragma once
/// Small DICOM files in every form that is read, and some that are refused.

#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// (name, bytes) each.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> dicomSeeds();

}  // namespace palpate
