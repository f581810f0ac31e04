#pragma once
/// New DICOM identifiers that say nothing about the machine or the time, unlike DCMTK's own: a UUID
/// under 2.25 (PS3.5 B.2).

#include <string>
#include <string_view>

namespace palpate {

/// From the system's random numbers.
[[nodiscard]] std::string randomUid();
/// Always the same for the same text, and without a way back to it (SHA-256): so that two exports
/// of a case lie in one frame of reference.
[[nodiscard]] std::string uidOf(std::string_view text);

}  // namespace palpate
