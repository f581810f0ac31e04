#include "imaging/dicom_list.h"

#include <algorithm>
#include <map>
#include <set>

#include "imaging/dicom_choice.h"
#include "imaging/dicom_series.h"
#include "imaging/thumbnail.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

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
    info.repair = stack.shape.repairs();
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

}  // namespace

Result<SeriesList> listDicomSeries(const fs::path& path, const Progress& progress,
                                   bool thumbnails) {
  const auto scan = scanDicom(path, progress);
  if (!scan) return fail(scan.error());
  if (scan->files.empty()) return fail(nothingThere(path, *scan));
  SeriesList list;
  list.skippedFiles = scan->skipped;
  list.warnings = scan->warnings;
  const auto stacks = stacksOf(scan->files);
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

}  // namespace palpate
