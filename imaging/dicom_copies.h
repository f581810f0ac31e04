#pragma once
/// Several images at one place, and files of a series that cannot be read: what becomes of the
/// stack.

#include <vector>

#include "imaging/dicom_stack.h"

namespace palpate {

/// Copies of an image are left out with a warning; different images at one place make the stack no
/// volume. Decodes them all.
void settleCopies(const std::vector<DicomFile>& files, DicomStack& stack);
/// Where one of a series' files is damaged, no stack of it is a volume: a slice may be missing.
void refuseDamagedFiles(const std::vector<DicomFile>& files, DicomStack& stack);

}  // namespace palpate
