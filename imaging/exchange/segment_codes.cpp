#include "imaging/exchange/segment_codes.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace palpate {
namespace {

constexpr SnomedCode kTissue{"85756007", "Tissue"};
constexpr SnomedCode kAnatomy{"123037004", "Anatomical Structure"};
constexpr SnomedCode kSubstance{"105590001", "Substance"};
constexpr SnomedCode kObject{"260787004", "Physical object"};

struct Row {
  const char* name;
  SegmentCodes codes;
};

/// Presets first, then the materials of datasets/materials.toml that are anatomy.
constexpr std::array<Row, 13> kRows{{
    {"bone", {kTissue, {"272673000", "Bone"}}},
    {"soft-tissue", {kTissue, {"87784001", "Soft tissue"}}},
    {"skin", {kTissue, {"39937001", "Skin"}}},
    {"air", {kSubstance, {"15158005", "Air"}}},
    {"brain", {kAnatomy, {"12738006", "Brain"}}},
    {"tissue", {kTissue, kTissue}},
    {"tooth", {kAnatomy, {"38199008", "Tooth"}}},
    {"teeth", {kAnatomy, {"38199008", "Tooth"}}},
    {"cartilage", {kTissue, {"309312004", "Cartilage"}}},
    {"dura", {kAnatomy, {"18545000", "Dura mater"}}},
    {"nerve", {kTissue, {"119410002", "Nerve"}}},
    {"vessel", {kTissue, {"59820001", "Blood vessel"}}},
    {"metal", {kObject, {"40388003", "Implant"}}},
}};

}  // namespace

SegmentCodes segmentCodes(const std::string& labelName) {
  std::string name = labelName;
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) {
    return c == ' ' || c == '_' ? '-' : static_cast<char>(std::tolower(c));
  });
  const auto* row =
      std::find_if(kRows.begin(), kRows.end(), [&name](const Row& r) { return name == r.name; });
  return row == kRows.end() ? SegmentCodes{kTissue, kTissue} : row->codes;
}

}  // namespace palpate
