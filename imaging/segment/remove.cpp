#include <algorithm>

#include "imaging/segment/edit.h"

namespace palpate {

Result<void> carryOut(Edit& edit, const tool::Remove&) {
  edit.share("Removing the label").at(0.1);
  std::replace(edit.labels.labels.begin(), edit.labels.labels.end(), edit.value, std::uint8_t{0});
  std::erase_if(edit.table, [&](const LabelInfo& l) { return l.value == edit.value; });
  return {};
}

}  // namespace palpate
