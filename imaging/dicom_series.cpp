#include "imaging/dicom_series.h"

#include <algorithm>
#include <cstdlib>
#include <map>

#include "imaging/dicom_copies.h"

namespace palpate {
namespace {

// Direction cosines that differ by more are another orientation (0.06 degrees).
constexpr double kSameDirection = 1e-3;

/// One group: same series, size, spacing and orientation.
struct Group {
  std::string seriesUid;
  std::vector<FrameRef> frames;
};

bool sameGrid(const std::vector<DicomFile>& files, const FrameRef& a, const FrameRef& b) {
  const DicomFile& fa = files[a.file];
  const DicomFile& fb = files[b.file];
  const DicomFrame& x = frameOf(files, a);
  const DicomFrame& y = frameOf(files, b);
  return fa.rows == fb.rows && fa.columns == fb.columns && x.hasOrientation == y.hasOrientation &&
         x.hasPosition == y.hasPosition && x.hasSpacing == y.hasSpacing &&
         (x.row - y.row).norm() < kSameDirection && (x.column - y.column).norm() < kSameDirection &&
         (x.spacing_mm - y.spacing_mm).norm() < 1e-4;
}

std::vector<Group> groupFrames(const std::vector<DicomFile>& files) {
  std::vector<Group> groups;
  std::map<std::string, std::vector<std::size_t>> ofSeries;
  for (std::size_t f = 0; f < files.size(); ++f) {
    if (!files[f].problem.empty()) continue;
    for (std::size_t n = 0; n < files[f].frames.size(); ++n) {
      const FrameRef ref{f, n};
      auto& candidates = ofSeries[files[f].seriesUid];
      const auto match = std::find_if(candidates.begin(), candidates.end(), [&](std::size_t g) {
        return sameGrid(files, groups[g].frames.front(), ref);
      });
      if (match != candidates.end()) {
        groups[*match].frames.push_back(ref);
      } else {
        candidates.push_back(groups.size());
        groups.push_back({files[f].seriesUid, {ref}});
      }
    }
  }
  return groups;
}

/// Which of the phase texts splits the group into equal parts with one image a place each.
std::vector<Group> splitPhases(const std::vector<DicomFile>& files, const Group& group,
                               std::size_t places) {
  for (std::size_t key = 0; key < kPhaseNames.size(); ++key) {
    std::map<std::string, Group> parts;
    for (const FrameRef& ref : group.frames) {
      Group& part = parts[frameOf(files, ref).phase[key]];
      part.seriesUid = group.seriesUid;
      part.frames.push_back(ref);
    }
    const bool even = parts.size() > 1 && std::all_of(parts.begin(), parts.end(), [&](auto& p) {
                        return p.second.frames.size() == places;
                      });
    if (!even) continue;
    std::vector<Group> out;
    for (auto& part : parts) out.push_back(std::move(part.second));
    // Numbers sort as numbers: phase 10 comes after phase 2.
    std::stable_sort(out.begin(), out.end(), [&](const Group& a, const Group& b) {
      return std::atof(frameOf(files, a.frames.front()).phase[key].c_str()) <
             std::atof(frameOf(files, b.frames.front()).phase[key].c_str());
    });
    return out;
  }
  return {};
}

/// Several images at each place: phases (a stack each), or copies, which the importer compares.
std::vector<DicomStack> makeStacks(const std::vector<DicomFile>& files, const Group& group) {
  DicomStack stack = makeStack(files, group.frames);
  if (stack.duplicates.empty() || stack.slices.empty()) return {stack};
  std::vector<DicomStack> phases;
  for (const Group& part : splitPhases(files, group, stack.slices.size())) {
    phases.push_back(makeStack(files, part.frames));
    if (!phases.back().duplicates.empty()) return {stack};
  }
  if (phases.empty()) return {stack};
  return phases;
}

}  // namespace

std::vector<DicomStack> groupIntoStacks(const std::vector<DicomFile>& files) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<DicomStack>> ofSeries;
  for (const Group& group : groupFrames(files)) {
    if (!ofSeries.contains(group.seriesUid)) order.push_back(group.seriesUid);
    for (DicomStack& stack : makeStacks(files, group)) {
      ofSeries[group.seriesUid].push_back(std::move(stack));
    }
  }
  std::vector<DicomStack> stacks;
  for (const std::string& uid : order) {
    auto& own = ofSeries[uid];
    std::stable_sort(own.begin(), own.end(), [](const DicomStack& a, const DicomStack& b) {
      return a.slices.size() > b.slices.size();
    });
    // The plain UID means the one stack that can be meant by it: the only one, or the only one of
    // several slices. Of several single images, none is meant more than the others.
    const bool firstIsMeant =
        own.size() == 1 || (own[0].slices.size() > 1 && own[1].slices.size() < 2);
    for (std::size_t i = 0; i < own.size(); ++i) {
      if (i > 0 || !firstIsMeant) own[i].uid = uid + "#" + std::to_string(i + 1);
      stacks.push_back(std::move(own[i]));
    }
  }
  return stacks;
}

std::vector<DicomStack> stacksOf(const std::vector<DicomFile>& files) {
  auto stacks = groupIntoStacks(files);
  for (DicomStack& stack : stacks) {
    settleCopies(files, stack);
    refuseDamagedFiles(files, stack);
  }
  return stacks;
}

}  // namespace palpate
