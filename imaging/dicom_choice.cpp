#include "imaging/dicom_choice.h"

#include <algorithm>

#include "core/base/counted.h"
#include "imaging/archive.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

Error notAVolume(const fs::path& path, const DicomProblem& problem) {
  const bool damaged = problem.reason == kDamagedFile;
  Error error = inputRefused((damaged ? "A DICOM image could not be decoded: "
                                      : "The series cannot become a volume: ") +
                             problem.reason + ".")
                    .inFile(path.string());
  if (!problem.field.empty()) error.inField(problem.field);
  if (!problem.found.empty()) error.butFound(problem.found);
  if (!problem.expected.empty()) error.wants(problem.expected);
  error.advise(damaged ? "Copy the file again from where it came."
                       : "Choose another series of the study; `palpate series PATH` lists them.");
  return error;
}

Error severalVolumes(const fs::path& path, const std::vector<DicomFile>& files,
                     const std::vector<const DicomStack*>& stacks) {
  std::string list;
  for (const DicomStack* stack : stacks) {
    list += (list.empty() ? "" : "; ") + stack->uid + " (" + modalityOf(files, *stack) + ", " +
            counted(stack->slices.size(), "slice)", "slices)") + (stack->scout ? ", a scout" : "");
  }
  return inputRefused("There are several volumes in there.")
      .inFile(path.string())
      .inField("series")
      .butFound(list)
      .wants("one series")
      .advise("Name one with --series UID.");
}

bool isVolume(const DicomStack& stack) {
  return stack.problem.empty() || stack.needsRepair;
}

/// The series' UID without the "#2" of a part.
std::string baseUid(const std::string& uid) {
  return uid.substr(0, uid.find('#'));
}

/// What is left when scouts go where there is anything else, and single images where a stack of the
/// same series has several.
std::vector<const DicomStack*> withoutScouts(std::vector<const DicomStack*> candidates) {
  const auto keep = [&candidates](auto&& wanted) {
    if (std::any_of(candidates.begin(), candidates.end(), wanted)) {
      std::erase_if(candidates, [&](const DicomStack* s) { return !wanted(s); });
    }
  };
  keep([](const DicomStack* s) { return !s->scout; });
  const bool oneSeries = std::all_of(
      candidates.begin(), candidates.end(),
      [&](const DicomStack* s) { return baseUid(s->uid) == baseUid(candidates.front()->uid); });
  if (oneSeries) keep([](const DicomStack* s) { return s->slices.size() > 1; });
  return candidates;
}

/// Where no stack of images is asked for: an object of that series that holds none, or nothing.
Error noImages(const std::vector<DicomFile>& files, const ImportRequest& request) {
  const auto object = std::find_if(files.begin(), files.end(), [&](const DicomFile& f) {
    return !request.seriesUid || f.seriesUid == *request.seriesUid;
  });
  if (object != files.end()) return notAVolume(request.path, object->problem);
  return inputRefused("There is no such series in there.")
      .inFile(request.path.string())
      .inField("series")
      .advise("List the series with: palpate series PATH");
}

}  // namespace

Error nothingThere(const fs::path& path, const DicomScan& scan) {
  std::error_code ec;
  if (fs::is_regular_file(path, ec) && mayBeDicom(path)) {
    return inputRefused("The DICOM file holds no image, or is damaged.")
        .inFile(path.string())
        .wants("a CT or MR image")
        .advise("Choose another file of the study, or its folder.");
  }
  if (!fs::is_directory(path, ec) && !isArchive(path)) {
    return inputRefused("The file is not a scan that Palpate reads.")
        .inFile(path.string())
        .wants("DICOM, InVesalius (.inv3), NIfTI, NRRD or MetaImage")
        .advise("Choose the scan itself; a file with the right ending may still be damaged.");
  }
  return inputRefused(scan.skipped == 0 ? "There are no files in there."
                                        : "There are no DICOM images in there.")
      .inFile(path.string())
      .butFound(std::to_string(scan.skipped) + " other files")
      .wants("the images of a CT or MR study")
      .advise("Choose the folder, disc or archive that holds the study.");
}

Result<const DicomStack*> chooseStack(const std::vector<DicomStack>& stacks, const DicomScan& scan,
                                      const ImportRequest& request) {
  if (scan.files.empty()) return fail(nothingThere(request.path, scan));
  std::vector<const DicomStack*> candidates;
  for (const DicomStack& stack : stacks) {
    if (!request.seriesUid || stack.uid == *request.seriesUid ||
        baseUid(stack.uid) == *request.seriesUid) {
      candidates.push_back(&stack);
    }
  }
  if (candidates.empty()) return fail(noImages(scan.files, request));
  const DicomStack* first = candidates.front();
  if (request.seriesUid && first->uid == *request.seriesUid) candidates = {first};
  const DicomProblem& problem = first->problem;
  std::erase_if(candidates, [](const DicomStack* s) { return !isVolume(*s); });
  if (candidates.empty()) return fail(notAVolume(request.path, problem));
  const auto meant = withoutScouts(candidates);
  if (meant.size() > 1) return fail(severalVolumes(request.path, scan.files, candidates));
  return meant.front();
}

}  // namespace palpate
