#include "imaging/dicom_import.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <map>
#include <set>

#include "imaging/dicom_scan.h"
#include "imaging/dicom_series.h"
#include "imaging/dicom_volume.h"
#include "imaging/regular_stack.h"
#include "imaging/thumbnail.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// The description goes into the case, so it must not carry a part of the name or the identifier.
std::string withoutNames(const DicomFile& file) {
  const std::string text = lowered(file.description);
  const std::string all = lowered(file.patientName + "^" + file.patientId);
  std::string part;
  for (const char c : all + "^") {
    if (c != '^' && c != '=' && c != ' ') {
      part.push_back(c);
      continue;
    }
    if (part.size() >= 3 && text.find(part) != std::string::npos) return {};
    part.clear();
  }
  return file.description;
}

std::string nameOf(const std::vector<DicomFile>& files, const FrameRef& ref) {
  const DicomFile& file = files[ref.file];
  return file.frames.size() == 1 ? file.name
                                 : file.name + " frame " + std::to_string(ref.frame + 1);
}

/// Images of one place: copies are left out, different ones make the stack no volume.
void settleDuplicates(const std::vector<DicomFile>& files, DicomStack& stack) {
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
    if (names.empty()) names = nameOf(files, slice) + " and " + nameOf(files, image);
  }
  if (more > 0) {
    return refuse({"different images lie at the same place: " + names + " (" +
                       std::to_string(stack.slices.size() + more) + " different images at " +
                       std::to_string(stack.slices.size()) + " places)",
                   "ImagePositionPatient", "the same in " + names, "one image a place"});
  }
  stack.warnings.push_back(std::to_string(stack.duplicates.size()) +
                           (stack.duplicates.size() == 1 ? " identical copy of an image was"
                                                         : " identical copies of images were") +
                           " left out.");
}

void refuseDamagedFiles(const std::vector<DicomFile>& files, DicomStack& stack) {
  const std::string& series = files[stack.slices.front().file].seriesUid;
  const auto isDamaged = [&](const DicomFile& f) { return f.seriesUid == series && f.damaged; };
  const auto damaged = std::count_if(files.begin(), files.end(), isDamaged);
  if (damaged == 0) return;
  const auto first = std::find_if(files.begin(), files.end(), isDamaged);
  stack.problem = {
      .reason = std::to_string(damaged) + " of its files are damaged or cut short",
      .field = first->problem.field,
      .found = first->name + (first->problem.found.empty() ? "" : ": " + first->problem.found),
      .expected = "whole files"};
  stack.needsRepair = false;
}

std::vector<DicomStack> stacksOf(const DicomScan& scan) {
  auto stacks = groupIntoStacks(scan.files);
  for (DicomStack& stack : stacks) {
    settleDuplicates(scan.files, stack);
    refuseDamagedFiles(scan.files, stack);
  }
  return stacks;
}

std::string repairWords(const DicomStack& stack) {
  if (stack.shape.tilted() && stack.shape.uneven()) return "tilt,spacing";
  return stack.shape.tilted() ? "tilt" : "spacing";
}

void describeStudy(const DicomFile& file, SeriesInfo& info) {
  info.patientName = file.patientName;
  info.patientId = file.patientId;
  info.studyDate = file.studyDate;
}

SeriesInfo infoOf(const std::vector<DicomFile>& files, const DicomStack& stack) {
  const DicomFile& first = files[stack.slices.front().file];
  std::set<std::size_t> members;
  for (const FrameRef& ref : stack.slices) members.insert(ref.file);
  for (const FrameRef& ref : stack.duplicates) members.insert(ref.file);
  SeriesInfo info;
  info.uid = stack.uid;
  info.modality = modalityOf(files, stack);
  info.description = first.description;
  describeStudy(first, info);
  info.files = members.size();
  for (const std::size_t member : members) info.bytes += files[member].bytes;
  info.importable = stack.problem.empty();
  info.reason = stack.problem.reason;
  if (stack.needsRepair) {
    info.repair = repairWords(stack);
    info.reason += "; imports with --repair " + info.repair;
  }
  info.geometry = stack.geometry;
  return info;
}

/// Objects that hold no grey image, one entry a series.
void listOthers(const std::vector<DicomFile>& files, SeriesList& list) {
  for (const DicomFile& file : files) {
    if (file.problem.empty()) continue;
    const auto known =
        std::find_if(list.series.begin(), list.series.end(),
                     [&](const SeriesInfo& s) { return s.uid == file.seriesUid && !s.importable; });
    if (known != list.series.end()) {
      ++known->files;
      known->bytes += file.bytes;
      continue;
    }
    SeriesInfo info;
    info.uid = file.seriesUid;
    info.modality = file.modality;
    info.description = file.description;
    describeStudy(file, info);
    info.files = 1;
    info.bytes = file.bytes;
    info.reason = file.problem.reason;
    list.series.push_back(std::move(info));
  }
}

/// By the study's UID, in the order of the list.
void numberStudies(const std::vector<DicomFile>& files, SeriesList& list) {
  std::map<std::string, std::string> studyOfSeries;
  for (const DicomFile& file : files) studyOfSeries.emplace(file.seriesUid, file.studyUid);
  std::map<std::string, std::size_t> numbers;
  for (SeriesInfo& info : list.series) {
    const std::string& study = studyOfSeries[info.uid.substr(0, info.uid.find('#'))];
    info.study = numbers.emplace(study, numbers.size() + 1).first->second;
  }
}

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
            std::to_string(stack->slices.size()) +
            (stack->slices.size() == 1 ? " slice)" : " slices)") +
            (stack->scout ? ", a scout" : "");
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

/// One rule, with a series' UID and without: of what is asked for and can be a volume, the only one
/// that is no scout and no single image beside a stack. Otherwise the choice is the user's.
Result<const DicomStack*> choose(const std::vector<DicomStack>& stacks, const DicomScan& scan,
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

Result<void> refuseUnrepaired(const DicomStack& stack, const ImportRequest& request) {
  const bool tilt = stack.shape.tilted() && !request.repairTilt;
  const bool spacing = stack.shape.uneven() && !request.repairSpacing;
  if (!tilt && !spacing) return {};
  const std::string words = repairWords(stack);
  return fail(
      inputRefused("The series is not a regular box: " + stack.problem.reason + ".")
          .inFile(request.path.string())
          .inField(tilt ? "gantry tilt" : "slice spacing")
          .wants("slices at even distances, straight above each other")
          .advise("Import it with --repair " + words + " to have it resampled to a regular grid."));
}

std::vector<Eigen::Vector3d> positionsOf(const std::vector<DicomFile>& files,
                                         const DicomStack& stack) {
  std::vector<Eigen::Vector3d> positions;
  for (const FrameRef& ref : stack.slices) {
    positions.push_back(files[ref.file].frames[ref.frame].position_mm);
  }
  return positions;
}

Result<void> repair(const std::vector<DicomFile>& files, const DicomStack& stack,
                    ImportedScan& scan, const Progress& progress) {
  auto regular = makeRegularStack(scan.volume, positionsOf(files, stack), progress);
  if (!regular) return fail(regular.error());
  char grid[96];
  char moved[64];
  std::snprintf(grid, sizeof grid, "Resampled to a regular grid of %d slices %.4g mm apart",
                regular->volume.geometry.dims[2], regular->volume.geometry.spacing.z() * 1e3);
  std::snprintf(moved, sizeof moved, "Largest displacement of a slice: %.2f mm.",
                regular->largestDisplacement_mm);
  scan.repairs.push_back(std::string(grid) + "; before, " + stack.problem.reason + ". " + moved);
  scan.volume = std::move(regular->volume);
  return {};
}

void addWarnings(const std::vector<DicomStack>& stacks, const DicomStack& stack,
                 const DicomFile& first, ImportedScan& scan) {
  scan.warnings.insert(scan.warnings.end(), stack.warnings.begin(), stack.warnings.end());
  if (stacks.size() > 1) {
    scan.warnings.push_back("Left out: " + std::to_string(stacks.size() - 1) +
                            " other image stacks (scouts or other series).");
  }
  if (scan.volume.modality != first.modality) {
    const std::string& unit = first.frames.front().rescaleType;
    scan.warnings.push_back(
        "The values are not Hounsfield units, though the header calls the image CT (its kind: " +
        first.imageKind + (unit.empty() ? "" : ", unit: " + unit) +
        "). It is taken as an image of another modality (OT); no CT preset fits it.");
  }
  if (first.mosaic) {
    scan.warnings.emplace_back(
        "The image is a mosaic: slices side by side, not a place in the patient. Have the scanner "
        "or the archive send them one by one.");
  }
  if (first.photometric == "MONOCHROME1") {
    scan.warnings.emplace_back(
        "The scanner shows small values bright (MONOCHROME1); the values are kept as they are.");
  }
  if (scan.lossy) {
    scan.warnings.emplace_back(
        "The images were compressed with loss: fine detail is not reliable.");
  }
}

}  // namespace

Result<SeriesList> listDicomSeries(const fs::path& path, const Progress& progress,
                                   bool thumbnails) {
  const auto scan = scanDicom(path, progress);
  if (!scan) return fail(scan.error());
  if (scan->files.empty()) return fail(nothingThere(path, *scan));
  SeriesList list;
  list.skippedFiles = scan->skipped;
  list.warnings = scan->warnings;
  const auto stacks = stacksOf(*scan);
  for (const DicomStack& stack : stacks) {
    if (progress.cancelled()) return fail(cancelled());
    list.series.push_back(infoOf(scan->files, stack));
    if (thumbnails) list.series.back().thumbnail = thumbnailOf(scan->files, stack);
  }
  listOthers(scan->files, list);
  numberStudies(scan->files, list);
  std::stable_sort(list.series.begin(), list.series.end(),
                   [](const SeriesInfo& a, const SeriesInfo& b) { return a.study < b.study; });
  return list;
}

Result<ImportedScan> importDicom(const ImportRequest& request, const Progress& progress) {
  const auto part = [&progress](double from, double to) {
    Progress p;
    p.cancel = progress.cancel;
    p.report = [&progress, from, to](double fraction, const std::string& what) {
      progress(from + (to - from) * fraction, what);
    };
    return p;
  };
  const auto found = scanDicom(request.path, part(0.0, 0.3));
  if (!found) return fail(found.error());
  const auto stacks = stacksOf(*found);
  const auto chosen = choose(stacks, *found, request);
  if (!chosen) return fail(chosen.error());
  const DicomStack& stack = **chosen;
  if (auto regular = refuseUnrepaired(stack, request); !regular) return fail(regular.error());
  auto loaded = loadStack(found->files, stack, part(0.3, stack.needsRepair ? 0.7 : 1.0));
  if (!loaded) return fail(loaded.error());
  const DicomFile& first = found->files[stack.slices.front().file];
  ImportedScan scan;
  scan.volume = std::move(loaded->volume);
  scan.lossy = loaded->lossy;
  scan.sourceFormat = "DICOM";
  scan.description = withoutNames(first);
  if (stack.needsRepair) {
    if (auto done = repair(found->files, stack, scan, part(0.7, 1.0)); !done) {
      return fail(done.error());
    }
  }
  scan.warnings = found->warnings;
  addWarnings(stacks, stack, first, scan);
  if (request.keepNames) {
    scan.patientName = first.patientName;
    scan.patientId = first.patientId;
  }
  return scan;
}

}  // namespace palpate
