#pragma once
/// A case's labels out to a file of another program, and back in.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "imaging/case_folder.h"
#include "imaging/exchange/exchange_format.h"
#include "imaging/exchange/found_labels.h"

namespace palpate {

struct ExportRequest {
  std::filesystem::path caseFolder, file;
  std::vector<std::string> labels;  ///< Names; empty: all.
  bool overwrite = false;
  std::string programVersion;
};

struct ExportedLabel {
  std::string name;
  std::uint8_t value = 0;
  std::size_t voxels = 0;
};

struct ExportReport {
  ExchangeFormat format{};
  std::vector<ExportedLabel> labels;
  std::size_t triangles = 0;  ///< Of a surface.
  std::vector<std::string> warnings;
};

/// Format by extension (exchange_format.h). Whole or not at all. Refused: a file that is there
/// without `overwrite`, a place inside the case, a label that the case does not have, several
/// labels for a surface, and what the format cannot hold.
[[nodiscard]] Result<ExportReport> exportLabels(const ExportRequest& request,
                                                const Progress& progress = {});
/// The same of labels in memory. The case's folder is only refused as a place.
[[nodiscard]] Result<ExportReport> exportLabels(const ExportRequest& request, const CaseInfo& info,
                                                const LabelGrid& labels, const LabelTable& table,
                                                const Progress& progress = {});

/// The labels of a file on a case's grid. A surface is one label, "label-1". Where the file holds
/// one label, `only` renames it; where it holds several, `only` chooses one of them, by name.
/// Refused: what the readers refuse, no voxels, and a name that the file does not have.
[[nodiscard]] Result<FoundLabels> importLabels(const std::filesystem::path& file,
                                               const GridGeometry& geometry,
                                               const std::string& only,
                                               const Progress& progress = {});

/// Adds what was found to a case's labels, or replaces labels of the same name there: these keep
/// their value, colour and material. A new one keeps its value where that is free. `warnings` gets
/// a sentence where a material had to be guessed (not from `usual` rows or presets of its name).
[[nodiscard]] Result<void> mergeLabels(const FoundLabels& found, LabelGrid& labels,
                                       LabelTable& table, std::vector<std::string>& warnings,
                                       const LabelTable& usual = {});

struct JoinedLabels {
  LabelState state;
  std::vector<std::string> replaced, added;  ///< Names.
  std::vector<std::string> warnings;
};

/// What a case's labels become with those of a file: importLabels(), then mergeLabels(). `before`
/// may have no voxels (nothing labelled yet).
[[nodiscard]] Result<JoinedLabels> joinLabels(const std::filesystem::path& file,
                                              const GridGeometry& geometry, const std::string& only,
                                              LabelState before, const LabelTable& usual = {},
                                              const Progress& progress = {});

}  // namespace palpate
