#include "imaging/dicom_import.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <map>
#include <set>

#include "core/base/counted.h"
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

/// Images of one place: copies are left out, different ones make the stack no volume.
void settleDuplicates(const std::vector<DicomFile>& files, DicomStack& stack) {
  if (stack.duplicates.empty() || (!stack.reason.empty() && !stack.needsRepair)) return;
  const auto refuse = [&stack](const std::string& why) {
    stack.reason = why;
    stack.needsRepair = false;
  };
  std::vector<FrameRef> frames = stack.duplicates;
  for (const std::size_t slice : stack.duplicateOf) frames.push_back(stack.slices[slice]);
  const auto digests = imageDigests(files, frames);
  if (!digests) return refuse("one of its images cannot be decoded");
  for (std::size_t d = 0; d < stack.duplicates.size(); ++d) {
    const FrameRef& copy = stack.duplicates[d];
    const FrameRef& slice = stack.slices[stack.duplicateOf[d]];
    if (digests->at({copy.file, copy.frame}) != digests->at({slice.file, slice.frame})) {
      return refuse("different images lie at the same place (" +
                    std::to_string(stack.duplicates.size() + stack.slices.size()) + " images at " +
                    counted(stack.slices.size(), "place)", "places)"));
    }
  }
  stack.warnings.push_back(counted(stack.duplicates.size(),
                                   "identical copy of an image was left out.",
                                   "identical copies of images were left out."));
}

void refuseDamagedFiles(const std::vector<DicomFile>& files, DicomStack& stack) {
  const std::string& series = files[stack.slices.front().file].seriesUid;
  const auto damaged = std::count_if(files.begin(), files.end(), [&](const DicomFile& f) {
    return f.seriesUid == series && f.damaged;
  });
  if (damaged == 0) return;
  stack.reason = counted(static_cast<std::size_t>(damaged), "of its files is damaged or cut short",
                         "of its files are damaged or cut short");
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
  info.modality = first.modality;
  info.description = first.description;
  describeStudy(first, info);
  info.files = members.size();
  for (const std::size_t member : members) info.bytes += files[member].bytes;
  info.importable = stack.reason.empty();
  info.reason = stack.reason;
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
    info.reason = file.problem;
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
      .butFound(counted(scan.skipped, "other file", "other files"))
      .wants("the images of a CT or MR study")
      .advise("Choose the folder, disc or archive that holds the study.");
}

Error notAVolume(const fs::path& path, const std::string& reason) {
  if (reason == kDamagedFile) {
    return inputRefused("A DICOM image could not be decoded: " + reason + ".")
        .inFile(path.string())
        .advise("Copy the file again from where it came.");
  }
  return inputRefused("The series cannot become a volume: " + reason + ".")
      .inFile(path.string())
      .advise("Choose another series of the study; `palpate series PATH` lists them.");
}

Error severalVolumes(const fs::path& path, const std::vector<DicomFile>& files,
                     const std::vector<const DicomStack*>& stacks) {
  std::string list;
  for (const DicomStack* stack : stacks) {
    list += (list.empty() ? "" : "; ") + stack->uid + " (" +
            files[stack->slices.front().file].modality + ", " +
            counted(stack->slices.size(), "slice)", "slices)");
  }
  return inputRefused("There are several volumes in there.")
      .inFile(path.string())
      .inField("series")
      .butFound(list)
      .wants("one series")
      .advise("Name one with --series UID.");
}

bool isVolume(const DicomStack& stack) {
  return stack.reason.empty() || stack.needsRepair;
}

/// The series' UID without the "#2" of a part.
std::string baseUid(const std::string& uid) {
  return uid.substr(0, uid.find('#'));
}

/// Scouts and single images beside the one stack of the same series are not what is meant.
void dropScouts(std::vector<const DicomStack*>& candidates) {
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
}

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
  if (candidates.empty() && request.seriesUid && !stacks.empty()) {
    return fail(inputRefused("There is no such series in there.")
                    .inFile(request.path.string())
                    .inField("series")
                    .advise("List the series with: palpate series PATH"));
  }
  if (candidates.empty()) return fail(notAVolume(request.path, scan.files.front().problem));
  const DicomStack* first = candidates.front();
  if (request.seriesUid && first->uid == *request.seriesUid) candidates = {first};
  const std::string reason = first->reason;
  std::erase_if(candidates, [](const DicomStack* s) { return !isVolume(*s); });
  if (candidates.empty()) return fail(notAVolume(request.path, reason));
  dropScouts(candidates);
  if (candidates.size() > 1) return fail(severalVolumes(request.path, scan.files, candidates));
  return candidates.front();
}

Result<void> refuseUnrepaired(const DicomStack& stack, const ImportRequest& request) {
  const bool tilt = stack.shape.tilted() && !request.repairTilt;
  const bool spacing = stack.shape.uneven() && !request.repairSpacing;
  if (!tilt && !spacing) return {};
  const std::string words = repairWords(stack);
  return fail(
      inputRefused("The series is not a regular box: " + stack.reason + ".")
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
  scan.repairs.push_back(std::string(grid) + "; before, " + stack.reason + ". " + moved);
  scan.volume = std::move(regular->volume);
  return {};
}

void addWarnings(const std::vector<DicomStack>& stacks, const DicomStack& stack,
                 const DicomFile& first, ImportedScan& scan) {
  scan.warnings.insert(scan.warnings.end(), stack.warnings.begin(), stack.warnings.end());
  if (stacks.size() > 1) {
    scan.warnings.push_back(
        "Left out: " + counted(stacks.size() - 1, "other image stack", "other image stacks") +
        " (scouts or other series).");
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
  addWarnings(stacks, stack, first, scan);
  if (request.keepNames) {
    scan.patientName = first.patientName;
    scan.patientId = first.patientId;
  }
  return scan;
}

}  // namespace palpate
