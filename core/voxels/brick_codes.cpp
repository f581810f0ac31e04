#include "core/voxels/brick_codes.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

using Cell = std::array<std::int32_t, 3>;

}  // namespace

// Cells of equal corners have equal sites: a table by the corners' codes that forgets what it must.
struct BrickCoder::Seen {
  static constexpr std::size_t kEntries = 1 << 14;
  struct Entry {
    std::array<std::uint16_t, 8> codes{};
    bool known = false, reached = false;
    RegionSite site;
  };
  std::vector<Entry> entry = std::vector<Entry>(kEntries);

  [[nodiscard]] Entry& at(const std::array<std::uint16_t, 8>& codes) noexcept {
    std::uint64_t hash = 0;
    for (const std::uint16_t c : codes) hash = (hash ^ c) * 0x9E3779B97F4A7C15ULL;
    return entry[hash >> 50];
  }
};

BrickCoder::BrickCoder(const LabelGrid& grid, const DepthPalette& palette,
                       std::uint8_t uniformLabel)
    : grid_(grid), palette_(palette), uniformLabel_(uniformLabel), seen_(std::make_unique<Seen>()) {
  for (std::size_t a = 0; a < 3; ++a) edge_[a] = std::sqrt(palette.weight()[a]);
}
BrickCoder::~BrickCoder() = default;

bool BrickCoder::site(const std::array<std::uint16_t, 8>& codes, RegionSite& out) {
  Seen::Entry& entry = seen_->at(codes);
  if (!entry.known || entry.codes != codes) {
    entry.codes = codes;
    entry.known = true;
    std::array<float, 8> corner;
    for (std::size_t i = 0; i < 8; ++i) corner[i] = palette_.value(codes[i]);
    entry.reached = siteOfCell(corner, edge_, kDepthSlack, entry.site);
  }
  out = entry.site;
  return entry.reached;
}

void BrickCoder::code(const SquareView& view, const Cell& cell, Brick& out) {
  std::uint16_t codes[125];
  std::uint32_t inside[DepthBricks::kRows];  // a bit a corner
  std::uint16_t highest = 0;
  bool allDeep = true;
  out.rows.fill(0);
  const auto clampTo = [this](std::int32_t i, std::size_t a) {
    return std::min(i, grid_.geometry.dims[a] - 1);
  };
  const std::uint16_t saturated = palette_.saturatedCode();
  std::size_t at = 0;
  for (int z = 0; z < 5; ++z) {
    for (int y = 0; y < 5; ++y) {
      const auto row = static_cast<std::size_t>(y + 5 * z);
      std::uint32_t low = 0;
      std::uint32_t high = 0;
      inside[row] = 0;
      for (int x = 0; x < 5; ++x, ++at) {
        const float square =
            view.at(clampTo(cell[0] + x, 0), clampTo(cell[1] + y, 1), clampTo(cell[2] + z, 2));
        const std::uint16_t c = palette_.codeOf(square);
        codes[at] = c;
        low |= (c & 63U) << (6 * x);
        high |= static_cast<std::uint32_t>(c >> 6) << (6 * x);
        inside[row] |= static_cast<std::uint32_t>(square < 0.0f) << x;
        highest = std::max(highest, c);
        allDeep = allDeep && square < 0.0f && c >= saturated;
      }
      out.rows[row] = low;
      out.rows[DepthBricks::kSlotWords + row] = high;
    }
  }
  out.wide = highest >= DepthPalette::kNarrow;
  out.deep = allDeep;
  out.fullCells = 0;
  out.sites.clear();
  for (int z = 0; z < 4; ++z) {
    for (int y = 0; y < 4; ++y) {
      const auto row = static_cast<std::size_t>(y + 5 * z);
      const std::uint32_t r[4] = {inside[row], inside[row + 1], inside[row + 5], inside[row + 6]};
      const std::uint32_t any = r[0] | r[1] | r[2] | r[3];
      const std::uint32_t all = r[0] & r[1] & r[2] & r[3];
      for (int x = 0; x < 4; ++x) {
        if ((any >> x & 3U) == 0) continue;
        if ((all >> x & 3U) == 3U) {
          out.fullCells |= std::uint64_t{1} << cellBit(x, y, z);
        } else {
          const std::size_t c = row * 5 + static_cast<std::size_t>(x);
          RegionSite s;
          if (!site({codes[c], codes[c + 1], codes[c + 5], codes[c + 6], codes[c + 25],
                     codes[c + 26], codes[c + 30], codes[c + 31]},
                    s)) {
            continue;
          }
          s.cell = static_cast<std::uint8_t>(cellBit(x, y, z));
          out.sites.push_back(s);
        }
      }
    }
  }
}

std::uint32_t BrickCoder::labels(const SquareView& view, const Cell& cell,
                                 std::vector<std::uint8_t>& bytes) const {
  if (uniformLabel_ != 0) return DepthBricks::kOneLabel | uniformLabel_;
  std::array<std::uint8_t, DepthBricks::kLabelBytes> label{};
  std::uint8_t first = 0;
  bool same = true;
  std::size_t at = 0;
  const auto& dims = grid_.geometry.dims;
  for (int z = 0; z < 5; ++z) {
    for (int y = 0; y < 5; ++y) {
      for (int x = 0; x < 5; ++x, ++at) {
        const std::int32_t i = std::min(cell[0] + x, dims[0] - 1);
        const std::int32_t j = std::min(cell[1] + y, dims[1] - 1);
        const std::int32_t k = std::min(cell[2] + z, dims[2] - 1);
        if (view.at(i, j, k) > 0.0f) continue;
        label[at] = grid_.at(i, j, k);
        if (first == 0) first = label[at];
        same = same && label[at] == first;
      }
    }
  }
  if (same) return DepthBricks::kOneLabel | first;
  const auto number = static_cast<std::uint32_t>(bytes.size() / DepthBricks::kLabelBytes);
  bytes.insert(bytes.end(), label.begin(), label.end());
  return number;
}

}  // namespace palpate
