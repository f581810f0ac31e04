#include "core/voxels/tree_cache.h"

#define XXH_INLINE_ALL
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <type_traits>
#include <vector>

#include "core/base/whole_file.h"
#include "core/voxels/cache_archive.h"
#include "core/voxels/leaf_codes.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {
namespace {

// Raise it whenever the arrays or their meaning change.
constexpr std::uint32_t kVersion = 2;
constexpr std::uint32_t kByteOrder = 0x01020304;
constexpr char kMagic[8] = {'P', 'A', 'L', 'P', 'T', 'R', 'E', 'E'};

struct Header {
  char magic[8];
  std::uint32_t version, byteOrder;
  std::uint64_t source, length, checksum;
  std::uint64_t reserved[3];
};
static_assert(sizeof(Header) == 64 && std::is_trivially_copyable_v<Header>);

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
  a.array(d.leafBytes);
  for (auto& n : d.depth.blocks) a.value(n);
  a.array(d.depth.coarse);
  a.array(d.depth.firstWord);
  a.array(d.depth.words);
  a.array(d.depth.slots);
  a.value(d.depth.uniformLabel);
  a.array(d.depth.label);
  a.array(d.depth.labelBytes);
}

Error refused(std::string message) {
  return inputRefused(std::move(message))
      .advise("Delete the file; the tree is then built from the labels again.");
}

// The bytes that a node of level 1 links to.
bool leavesHold(const VoxelTree::Data& d, std::uint32_t link, std::size_t count) {
  const std::size_t bytes = leafBytesOf(count, (link & kWideLeaves) != 0, d.depth.uniformLabel == 0,
                                        d.options.surfaceOnly);
  return (link & ~kWideLeaves) + bytes <= d.leafBytes.size();
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
    const std::size_t below = l > 1 ? d.level[l - 1].masks.size() / Mask::kBytes : 0;
    for (std::size_t n = 0; n < nodes; ++n) {
      const auto count = static_cast<std::size_t>(Mask::load(at.masks.data(), n).count());
      if (l > 1 && at.firstChild[n] + count > below) return false;
      if (l == 1 && !linkless && !leavesHold(d, at.firstChild[n], count)) return false;
    }
  }
  return true;
}

bool bricksHold(const DepthBricks& d, const std::array<std::int32_t, 3>& extent) {
  std::size_t blocks = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    if (d.blocks[a] != (extent[a] + DepthBricks::kCoarseEdge - 1) / DepthBricks::kCoarseEdge) {
      return false;
    }
    blocks *= static_cast<std::size_t>(d.blocks[a]);
  }
  const std::size_t slots = d.slots.size() / DepthBricks::kSlotWords;
  if (d.coarse.size() != blocks || d.firstWord.size() != blocks || d.words.size() < 64 ||
      d.words.size() % 64 != 0 || slots == 0 || slots * DepthBricks::kSlotWords != d.slots.size()) {
    return false;
  }
  const auto linked = [](std::uint32_t word) { return (word & ClearanceWord::kLink) != 0; };
  for (std::size_t i = 0; i < blocks; ++i) {
    const std::size_t block = linked(d.coarse[i]) ? d.coarse[i] & ~ClearanceWord::kLink : 0;
    if (block >= d.words.size() / 64 || d.firstWord[i] != block * 64) return false;
  }
  for (std::size_t i = 0; i < d.words.size(); ++i) {
    if (!linked(d.words[i])) continue;
    const std::size_t place = DepthBricks::placeOf(d.words[i]);
    const std::size_t last =
        place / DepthBricks::kSlotWords + ((d.words[i] & DepthBricks::kWide) != 0);
    if (i < 64 || place % DepthBricks::kSlotWords != 0 || last >= slots) return false;
  }
  if (d.uniformLabel != 0) return d.label.empty() && d.labelBytes.empty();
  if (d.label.size() != d.words.size()) return false;
  for (std::size_t i = 0; i < d.label.size(); ++i) {
    if ((d.label[i] & DepthBricks::kOneLabel) == 0 && linked(d.words[i]) &&
        (d.label[i] + std::size_t{1}) * DepthBricks::kLabelBytes > d.labelBytes.size()) {
      return false;
    }
  }
  return true;
}

bool payloadHolds(const VoxelTree::Data& d) {
  if (d.options.leaf == LeafModel::Voxel) return d.depth.bytes() == 0;
  return d.leafBytes.empty() && bricksHold(d.depth, d.extent);
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
  const Eigen::Vector3d& spacing = d.geometry.spacing;
  if (spacing.maxCoeff() / spacing.minCoeff() > kMaxSpacingRatio) return false;
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
  CacheWriter key;
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
  CacheWriter writer;
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

namespace {

// `bytes` may be used in place where `owner` keeps them (and they are aligned and private).
Result<VoxelTree> readCache(char* bytes, std::size_t size, std::shared_ptr<void> owner,
                            std::uint64_t source) {
  Header header{};
  if (size < sizeof header) return fail(refused("The tree's cache file is cut short."));
  std::memcpy(&header, bytes, sizeof header);
  bytes += sizeof header;
  size -= sizeof header;
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
  if (header.length != size) return fail(refused("The tree's cache file is cut short."));
  if (header.checksum != XXH3_64bits(bytes, size)) {
    return fail(refused("The tree's cache file is damaged."));
  }
  auto data = std::make_unique<VoxelTree::Data>();
  CacheReader reader(bytes, size, std::move(owner));
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
  data->stats.levels = data->levels;
  data->spheres = SphereTable(data->bits, data->geometry.spacing);
  data->depth.palette = DepthPalette(data->geometry.spacing);
  return VoxelTree::adopt(std::move(data));
}

}  // namespace

Result<VoxelTree> treeFromCache(std::string_view bytes, std::uint64_t source) {
  // Without an owner the bytes are only read.
  return readCache(const_cast<char*>(bytes.data()), bytes.size(), nullptr, source);
}

Result<void> saveTreeCache(const VoxelTree& tree, std::uint64_t source,
                           const std::filesystem::path& file) {
  return writeWholeFile(file, treeToCache(tree, source));
}

Result<VoxelTree> loadTreeCache(const std::filesystem::path& file, std::uint64_t source) {
  const auto unreadable = [&file] {
    return fail(refused("The tree's cache file cannot be read.").inFile(file.string()));
  };
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return unreadable();
  struct stat status {};
  const bool regular = fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
  const auto size = regular ? static_cast<std::size_t>(status.st_size) : 0;
  void* at = size > 0 ? mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE, descriptor, 0)
                      : MAP_FAILED;
  close(descriptor);
  if (regular && size == 0) {
    return fail(refused("The tree's cache file is cut short.").inFile(file.string()));
  }
  if (at == MAP_FAILED) return unreadable();
  std::shared_ptr<void> mapping(at, [size](void* p) { munmap(p, size); });
  auto tree = readCache(static_cast<char*>(at), size, mapping, source);
  if (!tree) return fail(Error(tree.error()).inFile(file.string()));
  return tree;
}

std::string treeCacheName(std::uint64_t source) {
  char name[32];
  std::snprintf(name, sizeof name, "tree-%016llx.cache", static_cast<unsigned long long>(source));
  return name;
}

namespace {

// Trees of other labels or settings that a case keeps beside the newest.
constexpr std::size_t kKept = 4;

bool isTreeCache(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return name.starts_with("tree-") && name.ends_with(".cache");
}

void dropOldCaches(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  std::vector<std::pair<fs::file_time_type, fs::path>> files;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (!isTreeCache(at->path())) continue;
    const auto written = fs::last_write_time(at->path(), error);
    if (!error) files.emplace_back(written, at->path());
  }
  std::sort(files.rbegin(), files.rend());
  for (std::size_t i = kKept; i < files.size(); ++i) fs::remove(files[i].second, error);
}

}  // namespace

Result<VoxelTree> openOrBuildTree(const LabelGrid& grid, std::span<const std::uint8_t> labels,
                                  const TreeOptions& options, const std::filesystem::path& folder,
                                  const Progress& progress) {
  if (folder.empty()) return VoxelTree::build(grid, labels, options, progress);
  const std::uint64_t source = treeSourceFingerprint(grid, labels, options);
  const std::filesystem::path file = folder / treeCacheName(source);
  if (auto kept = loadTreeCache(file, source)) {
    progress(1.0, "Tree opened");
    return kept;
  }
  auto tree = VoxelTree::build(grid, labels, options, progress);
  // A cache that can't be written costs time the next time, and nothing else.
  if (tree && saveTreeCache(*tree, source, file)) dropOldCaches(folder);
  return tree;
}

}  // namespace palpate
