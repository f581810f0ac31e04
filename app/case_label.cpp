#include "app/case_label.h"

namespace palpate {

Result<std::uint8_t> labelValue(const LabelTable& table, const std::string& name) {
  std::string names;
  for (const LabelInfo& row : table) {
    if (row.name == name) return row.value;
    names += (names.empty() ? "" : ", ") + row.name;
  }
  return fail(
      inputRefused("The case has no label of that name.")
          .inField("label")
          .butFound(name)
          .wants(names.empty() ? "a label" : "one of " + names)
          .advise("Make it with 'palpate segment CASE --preset NAME --label " + name + "'."));
}

}  // namespace palpate
