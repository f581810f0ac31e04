#include "app/segment_from_file.h"

#include "app/label_report.h"
#include "app/program_paths.h"
#include "core/base/whole_file.h"
#include "core/scene/anatomy.h"
#include "imaging/case_folder.h"
#include "imaging/exchange/label_exchange.h"
#include "imaging/segment/case_recipe.h"

namespace palpate {

Result<CommandOutput> segmentFromFile(const SegmentFromFile& request,
                                      const CommandContext& context) {
  if (request.partOptions) {
    return fail(usageError("--largest and --min-mm3 do not go with --from.")
                    .advise("Labels of a file are taken as they are."));
  }
  context.progress(0.0, "Reading the case");
  const Result<CaseInfo> info = readCaseInfo(request.caseFolder);
  if (!info) return fail(info.error());
  if (auto writable = checkWritable(request.caseFolder); !writable) return fail(writable.error());
  LabelState before;
  if (caseHasLabels(request.caseFolder)) {
    Result<LabelState> there = readCaseLabelState(request.caseFolder);
    if (!there) return fail(there.error());
    before = std::move(*there);
  }
  LabelTable usual;
  if (const auto datasets = datasetsFolder()) {
    if (const auto anatomies = readAnatomies(*datasets / "labels.toml")) {
      usual = rowsOfAnatomies(*anatomies);
    }
  }
  Result<JoinedLabels> joined = joinLabels(request.file, info->geometry, request.label,
                                           std::move(before), usual, context.progress);
  if (!joined) return fail(joined.error());
  const auto& [labels, table] = joined->state;
  if (auto written = writeCaseLabels(request.caseFolder, labels, table); !written) {
    return fail(written.error());
  }
  // The steps that were kept no longer make these labels by themselves.
  CaseRecipe recipe = readCaseRecipe(request.caseFolder);
  recipe.whole = false;
  if (auto written = writeCaseRecipe(request.caseFolder, recipe); !written) {
    return fail(written.error());
  }
  context.progress(1.0, "Labels taken over");
  return labelReport(labels, table, std::move(joined->warnings));
}

}  // namespace palpate
