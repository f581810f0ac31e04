#pragma once
/// What a label is, in the codes of DICOM segmentations (SNOMED CT; context groups 7150 and 7151).

#include <string>

namespace palpate {

/// Value and meaning in the coding scheme SCT.
struct SnomedCode {
  const char* value;
  const char* meaning;
};

struct SegmentCodes {
  SnomedCode category, type;
};

/// By the label's name ("bone", "brain", "soft-tissue", "air" ..., in any case); "Tissue" for names
/// that say nothing, since a code is a statement about the anatomy.
[[nodiscard]] SegmentCodes segmentCodes(const std::string& labelName);

}  // namespace palpate
