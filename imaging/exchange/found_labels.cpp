#include "imaging/exchange/found_labels.h"

#include <algorithm>
#include <set>

namespace palpate {
namespace {

bool isBlankOrControl(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte <= 0x20 || byte == 0x7F;
}

/// UTF-8 is cut between characters only.
void cutTo(std::string& text, std::size_t bytes) {
  if (text.size() <= bytes) return;
  while (bytes > 0 && (static_cast<unsigned char>(text[bytes]) & 0xC0U) == 0x80U) --bytes;
  text.resize(bytes);
}

}  // namespace

std::string labelName(const std::string& stated, int value, bool& changed) {
  std::string name = stated;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return isBlankOrControl(c); }, ' ');
  while (!name.empty() && name.back() == ' ') name.pop_back();
  name.erase(0, std::min(name.find_first_not_of(' '), name.size()));
  // Bytes, not characters: a name of 64 characters in any script has at most 4 bytes each.
  if (name.size() > 4 * kMaxLabelName) {
    cutTo(name, 4 * kMaxLabelName);
    changed = true;
  }
  return name.empty() ? "label-" + std::to_string(value) : name;
}

void settleLabels(FoundLabels& found) {
  std::array<bool, 256> used{};
  for (const std::uint8_t label : found.grid.labels) used[label] = true;
  const std::size_t stated = found.labels.size();
  std::erase_if(found.labels, [&used](const FoundLabel& l) { return !used[l.value]; });
  if (const std::size_t empty = stated - found.labels.size(); empty > 0) {
    found.warnings.push_back(std::to_string(empty) + " of the file's " + std::to_string(stated) +
                             " labels hold no voxels and are left out.");
  }
  std::sort(found.labels.begin(), found.labels.end(),
            [](const FoundLabel& a, const FoundLabel& b) { return a.value < b.value; });
  std::set<std::string> names;
  bool renamed = false;
  for (FoundLabel& label : found.labels) {
    const std::string stem = label.name;
    for (int n = 2; !names.insert(label.name).second; ++n) {
      label.name = stem + " (" + std::to_string(n) + ")";
      renamed = true;
    }
  }
  if (renamed) {
    found.warnings.emplace_back("Several labels of the file share a name; they are numbered.");
  }
}

}  // namespace palpate
