#include "app/label_report.h"

#include "app/text_table.h"
#include "imaging/segmentation.h"

namespace palpate {

CommandOutput labelReport(const LabelGrid& labels, const LabelTable& table,
                          std::vector<std::string> warnings) {
  CommandOutput output;
  output.json["labels"] = nlohmann::ordered_json::array();
  TextTable text({"label", "value", "voxels", "mm³"});
  for (const LabelCount& count : countLabels(labels, table)) {
    nlohmann::ordered_json row;
    row["name"] = count.name;
    row["value"] = count.value;
    row["voxels"] = count.voxels;
    row["mm3"] = count.mm3;
    output.json["labels"].push_back(row);
    text.add({count.name, std::to_string(count.value), std::to_string(count.voxels),
              decimal(count.mm3, 1)});
  }
  output.text = text.text();
  output.warnings = std::move(warnings);
  return output;
}

}  // namespace palpate
