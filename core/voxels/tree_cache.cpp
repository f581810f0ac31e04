#include "core/voxels/tree_cache.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <type_traits>
#include <vector>

#include "core/base/whole_file.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {
namespace {

// Raise it whenever the arrays or their meaning change.
constexpr std::uint32_t kVersion = 1;
constexpr std::uint32_t kByteOrder = 0x01020304;
constexpr char kMagic[8] = {'P', 'A', 'L', 'P', 'T', 'R', 'E', 'E'};

struct Header {
  char magic[8];
  std::uint32_t version, byteOrder;
  std::uint64_t source, length, checksum;
};
static_assert(sizeof(Header) == 40 && std::is_trivially_copyable_v<Header>);

class Writer {
 public:
  template <class T>
  void value(const T& v) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&v), sizeof v);
  }
  template <class T>
  void array(const std::vector<T>& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    value(static_cast<std::uint64_t>(v.size()));
    if (!v.empty()) bytes_.append(reinterpret_cast<const char*>(v.data()), v.size() * sizeof(T));
  }
  [[nodiscard]] std::string& bytes() { return bytes_; }

 private:
  std::string bytes_;
};

// Reads what Writer wrote; every length is checked against what is left before anything is taken.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}

  template <class T>
  void value(T& v) {
    if (rest_.size() < sizeof v) {
      good_ = false;
      return;
    }
    if constexpr (std::is_same_v<T, bool>) {
      v = rest_[0] != 0;  // any other byte would not be a bool
    } else {
      std::memcpy(&v, rest_.data(), sizeof v);
    }
    rest_.remove_prefix(sizeof v);
  }
  template <class T>
  void array(std::vector<T>& v) {
    std::uint64_t count = 0;
    value(count);
    if (!good_ || count > rest_.size() / sizeof(T)) {
      good_ = false;
      return;
    }
    v.resize(static_cast<std::size_t>(count));
    if (count != 0) std::memcpy(v.data(), rest_.data(), v.size() * sizeof(T));
    rest_.remove_prefix(v.size() * sizeof(T));
  }
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] bool atEnd() const { return good_ && rest_.empty(); }

 private:
  std::string_view rest_;
  bool good_ = true;
};

// One order of fields for both directions; `levels` is sized by the reader before.
template <class Archive, class Data>
void fields(Archive& a, Data& d) {
  for (auto& n : d.geometry.dims) a.value(n);
  for (int i = 0; i < 3; ++i) a.value(d.geometry.spacing[i]);
  for (int i = 0; i < 16; ++i) a.value(d.geometry.X_PV.matrix().data()[i]);
  a.value(d.options.branching);
  a.value(d.options.leaf);
  a.value(d.options.surfaceOnly);
  a.value(d.bits);
  a.value(d.levels);
  for (auto& n : d.extent) a.value(n);
  for (int i = 0; i < 3; ++i) a.value(d.origin[i]);
  a.value(d.stats.surfaceVoxels);
  a.value(d.stats.solidVoxels);
  a.value(d.stats.topologyBytes);
  a.value(d.stats.payloadBytes);
  a.value(d.stats.buildMs);
  a.array(d.stats.nodesPerLevel);
  a.array(d.leafLabel);
  a.array(d.leafNormal);
  a.array(d.leafDepth);
  a.value(d.brickLevel);
  a.value(d.brickEdge);
  a.array(d.brick);
  a.value(d.uniformLabel);
  a.array(d.brickLabel);
}

Error refused(std::string message) {
  return inputRefused(std::move(message))
      .advise("Delete the file; the tree is then built from the labels again.");
}

// Masks, links and payload must fit each other, so that no reader can leave an array.
template <int Bits>
bool linksHold(const VoxelTree::Data& d) {
  using Mask = NodeMask<Bits>;
  for (std::size_t l = 1; l < d.level.size(); ++l) {
    const TreeLevel& at = d.level[l];
    const std::size_t nodes = at.masks.size() / Mask::kBytes;
    if (nodes * Mask::kBytes != at.masks.size() || nodes == 0) return false;
    if (l + 1 == d.level.size() && nodes != 1) return false;
    const bool linkless = l == 1 && d.options.leaf == LeafModel::Distance;
    if (at.firstChild.size() != (linkless ? 0 : nodes)) return false;
    std::size_t next = 0;
    for (std::size_t n = 0; n < nodes; ++n) {
      const Mask mask = Mask::load(at.masks.data(), n);
      if (mask.empty() || (!linkless && at.firstChild[n] != next)) return false;
      next += static_cast<std::size_t>(mask.count());
    }
    const std::size_t below =
        l > 1 ? d.level[l - 1].masks.size() / Mask::kBytes : d.leafLabel.size();
    if (!linkless && next != below) return false;
  }
  return true;
}

bool payloadHolds(const VoxelTree::Data& d) {
  if (d.options.leaf == LeafModel::Voxel) {
    return d.leafNormal.size() == d.leafLabel.size() && d.leafDepth.size() == d.leafLabel.size() &&
           d.brick.empty();
  }
  if (d.brickLevel != brickLevelOf(d.bits, d.levels) ||
      d.brickEdge != 1 << (d.bits * d.brickLevel)) {
    return false;
  }
  const std::size_t perNode = (std::size_t{1} << (3 * d.bits)) / 8;
  const std::size_t bricks = d.level[static_cast<std::size_t>(d.brickLevel)].masks.size() / perNode;
  const std::size_t values = bricks * d.brickSize();
  return d.brick.size() == values && d.brickLabel.size() == (d.uniformLabel == 0 ? values : 0);
}

bool shapeHolds(const VoxelTree::Data& d) {
  if (d.bits < 1 || d.bits > 3 || d.levels < 1 || d.levels * d.bits > 30) return false;
  if (static_cast<int>(d.options.branching) != 1 << (3 * d.bits)) return false;
  if (d.options.leaf != LeafModel::Voxel && d.options.leaf != LeafModel::Distance) return false;
  const std::int32_t less = d.options.leaf == LeafModel::Distance ? 1 : 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double s = d.geometry.spacing[static_cast<Eigen::Index>(a)];
    if (!std::isfinite(s) || s <= 0.0 || d.geometry.dims[a] < 2) return false;
    if (d.extent[a] != d.geometry.dims[a] - less) return false;
    if (d.extent[a] > 1 << (d.bits * d.levels)) return false;
  }
  return d.geometry.X_PV.matrix().allFinite() && d.origin.allFinite();
}

bool holds(const VoxelTree::Data& d) {
  if (!shapeHolds(d)) return false;
  const bool links = d.bits == 1   ? linksHold<1>(d)
                     : d.bits == 2 ? linksHold<2>(d)
                                   : linksHold<3>(d);
  return links && payloadHolds(d);
}

}  // namespace

std::uint64_t treeSourceFingerprint(const LabelGrid& grid, std::span<const std::uint8_t> labels,
                                    const TreeOptions& options) {
  Writer key;
  key.value(kVersion);
  for (const auto n : grid.geometry.dims) key.value(n);
  for (int i = 0; i < 3; ++i) key.value(grid.geometry.spacing[i]);
  for (int i = 0; i < 16; ++i) key.value(grid.geometry.X_PV.matrix().data()[i]);
  key.value(options.branching);
  key.value(options.leaf);
  key.value(options.surfaceOnly);
  key.array(std::vector<std::uint8_t>(labels.begin(), labels.end()));
  key.value(XXH3_64bits(grid.labels.data(), grid.labels.size()));
  return XXH3_64bits(key.bytes().data(), key.bytes().size());
}

std::string treeToCache(const VoxelTree& tree, std::uint64_t source) {
  const VoxelTree::Data& d = tree.data();
  Writer writer;
  fields(writer, d);
  for (std::size_t l = 1; l < d.level.size(); ++l) {
    writer.array(d.level[l].masks);
    writer.array(d.level[l].firstChild);
  }
  std::string& body = writer.bytes();
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.version = kVersion;
  header.byteOrder = kByteOrder;
  header.source = source;
  header.length = body.size();
  header.checksum = XXH3_64bits(body.data(), body.size());
  return std::string(reinterpret_cast<const char*>(&header), sizeof header) + body;
}

Result<VoxelTree> treeFromCache(std::string_view bytes, std::uint64_t source) {
  Header header{};
  if (bytes.size() < sizeof header) return fail(refused("The tree's cache file is cut short."));
  std::memcpy(&header, bytes.data(), sizeof header);
  bytes.remove_prefix(sizeof header);
  if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0) {
    return fail(refused("The file is not a tree's cache."));
  }
  if (header.version != kVersion || header.byteOrder != kByteOrder) {
    return fail(refused("The tree's cache file is of another version.")
                    .butFound(std::to_string(header.version))
                    .wants(std::to_string(kVersion)));
  }
  if (header.source != source) {
    return fail(refused("The tree's cache file was made from other labels."));
  }
  if (header.length != bytes.size()) return fail(refused("The tree's cache file is cut short."));
  if (header.checksum != XXH3_64bits(bytes.data(), bytes.size())) {
    return fail(refused("The tree's cache file is damaged."));
  }
  auto data = std::make_unique<VoxelTree::Data>();
  Reader reader(bytes);
  fields(reader, *data);
  const bool countable = reader.good() && data->levels >= 1 && data->levels <= 30;
  data->level.resize(countable ? static_cast<std::size_t>(data->levels) + 1 : 0);
  for (std::size_t l = 1; l < data->level.size(); ++l) {
    reader.array(data->level[l].masks);
    reader.array(data->level[l].firstChild);
  }
  if (!countable || !reader.atEnd() || !holds(*data)) {
    return fail(refused("The tree's cache file contradicts itself."));
  }
  data->spheres = SphereTable(data->bits, data->geometry.spacing);
  return VoxelTree::adopt(std::move(data));
}

Result<void> saveTreeCache(const VoxelTree& tree, std::uint64_t source,
                           const std::filesystem::path& file) {
  return writeWholeFile(file, treeToCache(tree, source));
}

Result<VoxelTree> loadTreeCache(const std::filesystem::path& file, std::uint64_t source) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)),
                          std::istreambuf_iterator<char>());
  if (!stream.is_open() || stream.bad()) {
    return fail(refused("The tree's cache file cannot be read.").inFile(file.string()));
  }
  auto tree = treeFromCache(bytes, source);
  if (!tree) return fail(Error(tree.error()).inFile(file.string()));
  return tree;
}

}  // namespace palpate
