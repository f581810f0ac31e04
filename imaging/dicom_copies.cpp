#include "imaging/dicom_copies.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

#include "core/base/counted.h"
#include "imaging/dicom_volume.h"

namespace palpate {
namespace {

/// For a message: without the patient's name, and without what a terminal would obey.
std::string nameOf(const std::vector<DicomFile>& files, std::size_t file) {
  if (holdsName(files[file].name, files[file])) return "file " + std::to_string(file + 1);
  std::string name = files[file].name;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, '?');
  return name;
}

std::string nameOf(const std::vector<DicomFile>& files, const FrameRef& ref) {
  const bool one = files[ref.file].frames.size() == 1;
  return nameOf(files, ref.file) + (one ? "" : " frame " + std::to_string(ref.frame + 1));
}

std::string namesOf(const std::vector<DicomFile>& files, const FrameRef& a, const FrameRef& b) {
  const std::string first = nameOf(files, a);
  const std::string second = nameOf(files, b);
  return first == second ? "two files called " + first : first + " and " + second;
}

}  // namespace

void settleCopies(const std::vector<DicomFile>& files, DicomStack& stack) {
  if (stack.duplicates.empty() || (!stack.problem.empty() && !stack.needsRepair)) return;
  const auto refuse = [&stack](DicomProblem why) {
    stack.problem = std::move(why);
    stack.needsRepair = false;
  };
  std::vector<FrameRef> frames = stack.duplicates;
  for (const std::size_t slice : stack.duplicateOf) frames.push_back(stack.slices[slice]);
  const auto digests = imageDigests(files, frames);
  if (!digests) return refuse({.reason = "one of its images cannot be decoded"});
  const auto digest = [&](const FrameRef& r) { return digests->at({r.file, r.frame}); };
  std::map<std::size_t, std::set<std::string>> different;  // By place.
  std::size_t more = 0;                                    // Than one image a place.
  std::string names;                                       // Of the first two.
  for (std::size_t d = 0; d < stack.duplicates.size(); ++d) {
    const FrameRef& image = stack.duplicates[d];
    const FrameRef& slice = stack.slices[stack.duplicateOf[d]];
    std::set<std::string>& here = different[stack.duplicateOf[d]];
    here.insert(digest(slice));
    if (!here.insert(digest(image)).second) continue;
    ++more;
    if (names.empty()) names = namesOf(files, slice, image);
  }
  if (more > 0) {
    return refuse({"different images lie at the same place: " + names + " (" +
                       std::to_string(stack.slices.size() + more) + " different images at " +
                       std::to_string(stack.slices.size()) + " places)",
                   "ImagePositionPatient", "the same in " + names, "one image a place"});
  }
  stack.warnings.push_back(counted(stack.duplicates.size(),
                                   "identical copy of an image was left out.",
                                   "identical copies of images were left out."));
}

void refuseDamagedFiles(const std::vector<DicomFile>& files, DicomStack& stack) {
  const std::string& series = files[stack.slices.front().file].seriesUid;
  const auto isDamaged = [&](const DicomFile& f) { return f.seriesUid == series && f.damaged; };
  const auto damaged = std::count_if(files.begin(), files.end(), isDamaged);
  if (damaged == 0) return;
  const auto first = std::find_if(files.begin(), files.end(), isDamaged);
  stack.problem = {.reason = std::to_string(damaged) + " of its files are damaged or cut short",
                   .field = first->problem.field,
                   .found = nameOf(files, static_cast<std::size_t>(first - files.begin())) +
                            (first->problem.found.empty() ? "" : ": " + first->problem.found),
                   .expected = "whole files"};
  stack.needsRepair = false;
}

}  // namespace palpate
