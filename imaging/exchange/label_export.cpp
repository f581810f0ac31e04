#include <algorithm>
#include <array>

#include "core/base/whole_file.h"
#include "imaging/exchange/label_exchange.h"
#include "imaging/exchange/label_surface.h"
#include "imaging/exchange/label_volume.h"
#include "imaging/exchange/seg_write.h"
#include "imaging/exchange/surface_write.h"
#include "imaging/segmentation.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

Result<void> refusePlace(const ExportRequest& request) {
  std::error_code ec;
  const fs::path parent = request.file.has_parent_path() ? request.file.parent_path() : ".";
  if (fs::equivalent(parent, request.caseFolder, ec)) {
    return fail(inputRefused("The case's own folder is no place for an export.")
                    .inFile(request.file.string())
                    .wants("a place outside the case")
                    .advise("Choose another folder."));
  }
  if (!request.overwrite && fs::exists(fs::symlink_status(request.file, ec))) {
    return fail(inputRefused("The output exists.")
                    .inFile(request.file.string())
                    .wants("a new name")
                    .advise("Choose another name; `palpate export --force` replaces it."));
  }
  return checkWritable(request.file);
}

std::string namesOf(const LabelTable& table) {
  std::string names;
  for (const LabelInfo& row : table) names += (names.empty() ? "" : ", ") + row.name;
  return names;
}

/// The rows asked for, in the table's order; all where none is named.
Result<LabelTable> chosenRows(const LabelTable& table, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const bool known = std::any_of(table.begin(), table.end(),
                                   [&](const LabelInfo& row) { return row.name == name; });
    if (known) continue;
    return fail(inputRefused("The case has no label of that name.")
                    .inField("--label")
                    .butFound(name)
                    .wants("one of " + namesOf(table))
                    .advise("Choose a label of the case."));
  }
  LabelTable rows;
  std::copy_if(table.begin(), table.end(), std::back_inserter(rows), [&](const LabelInfo& row) {
    return names.empty() || std::find(names.begin(), names.end(), row.name) != names.end();
  });
  return rows;
}

/// Labels that are not exported become background.
LabelGrid onlyThese(const LabelTable& rows, const LabelGrid& grid) {
  std::array<std::uint8_t, 256> keep{};
  for (const LabelInfo& row : rows) keep[row.value] = row.value;
  LabelGrid kept{grid.geometry, std::vector<std::uint8_t>(grid.labels.size())};
  std::transform(grid.labels.begin(), grid.labels.end(), kept.labels.begin(),
                 [&keep](std::uint8_t label) { return keep[label]; });
  return kept;
}

Result<void> exportSurface(const ExportRequest& request, const LabelGrid& grid,
                           const LabelTable& rows, const Progress& progress, ExportReport& report) {
  if (rows.size() != 1) {
    return fail(usageError("A surface file holds one label.")
                    .inField("--label")
                    .butFound(std::to_string(rows.size()) + " labels")
                    .wants("one of " + namesOf(rows))
                    .advise("Choose one label, and export the others to files of their own; "
                            "`palpate export --label NAME` takes one."));
  }
  const auto mesh = labelSurface(grid, rows.front().value, progress);
  if (!mesh) return fail(mesh.error());
  report.triangles = mesh->triangles.size();
  return writeSurface(*mesh, rows.front().colour, report.format, request.file);
}

Result<void> exportSeg(const ExportRequest& request, const CaseInfo& info, const LabelGrid& grid,
                       const LabelTable& rows, const Progress& progress, ExportReport& report) {
  if (info.lossy) {
    report.warnings.emplace_back(
        "The scan had been compressed with loss; the file says so, but not by how much, which the "
        "case does not know.");
  }
  return writeDicomSeg(grid, rows,
                       {info.pseudonym, info.voxelsSha256, request.programVersion, info.lossy},
                       request.file, progress);
}

Result<ExportReport> write(const ExportRequest& request, ExchangeFormat format,
                           const CaseInfo& info, const LabelGrid& labels, const LabelTable& table,
                           const Progress& progress) {
  const auto rows = chosenRows(table, request.labels);
  if (!rows) return fail(rows.error());
  // All labels of the volume are of the table in most cases: then no copy is made.
  std::array<bool, 256> chosen{};
  chosen[0] = true;
  for (const LabelInfo& row : *rows) chosen[row.value] = true;
  const bool all = std::all_of(labels.labels.begin(), labels.labels.end(),
                               [&chosen](std::uint8_t label) { return chosen[label]; });
  const LabelGrid kept = all ? LabelGrid{} : onlyThese(*rows, labels);
  const LabelGrid& grid = all ? labels : kept;
  ExportReport report;
  report.format = format;
  for (const LabelCount& count : countLabels(grid, *rows)) {
    report.labels.push_back({count.name, count.value, count.voxels});
  }
  if (progress.cancelled()) return fail(cancelled());
  const Result<void> written =
      isSurface(format)                    ? exportSurface(request, grid, *rows, progress, report)
      : format == ExchangeFormat::DicomSeg ? exportSeg(request, info, grid, *rows, progress, report)
                                           : writeLabelVolume(grid, *rows, request.file);
  if (!written) return fail(written.error());
  progress(1.0, "Exported");
  return report;
}

}  // namespace

Result<ExportReport> exportLabels(const ExportRequest& request, const Progress& progress) {
  const auto format = exportFormat(request.file);
  if (!format) return fail(format.error());
  const auto info = readCaseInfo(request.caseFolder);
  if (!info) return fail(info.error());
  if (auto place = refusePlace(request); !place) return fail(place.error());
  progress(0.0, "Reading the labels");
  const auto state = readCaseLabelState(request.caseFolder);
  if (!state) return fail(state.error());
  return write(request, *format, *info, state->labels, state->table, progress);
}

Result<ExportReport> exportLabels(const ExportRequest& request, const CaseInfo& info,
                                  const LabelGrid& labels, const LabelTable& table,
                                  const Progress& progress) {
  const auto format = exportFormat(request.file);
  if (!format) return fail(format.error());
  if (auto place = refusePlace(request); !place) return fail(place.error());
  return write(request, *format, info, labels, table, progress);
}

}  // namespace palpate
