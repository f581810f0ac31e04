// A tree's cache file is refused, or the tree that comes out of it can be asked anything.

#define XXH_INLINE_ALL
#include <sys/mman.h>
#include <unistd.h>
#include <xxhash.h>

#include <cmath>
#include <cstring>
#include <random>

#include "core/collision/contact_finder.h"
#include "core/voxels/leaf_codes.h"
#include "core/voxels/node_mask.h"
#include "core/voxels/voxel_tree_data.h"
#include "tests/fuzz/fuzz_require.h"
#include "tests/fuzz/seed_trees.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t maxSize);

namespace palpate {
namespace {

constexpr std::size_t kHeader = 64;  // magic 8, version 4, order 4, source 8, length 8, checksum 8

// Links and codes from the root on, as any reader follows them.
template <int Bits>
std::size_t walk(const VoxelTree::Data& d, int level, std::size_t node, std::size_t& budget) {
  if (budget == 0) return 0;
  --budget;
  using Mask = NodeMask<Bits>;
  const TreeLevel& at = d.level[static_cast<std::size_t>(level)];
  const Mask mask = Mask::load(at.masks.data(), node);
  std::size_t sum = 0;
  std::size_t next = level > 1 ? at.firstChild[node] : 0;
  forEachChild(mask, [&](int c) {
    if (level > 1) {
      sum += walk<Bits>(d, level - 1, next++, budget);
    } else if (d.options.leaf == LeafModel::Voxel) {
      const std::uint32_t link = at.firstChild[node];
      const std::uint16_t code = leafCode(d.leafBytes, link, mask.rank(c));
      sum += static_cast<std::size_t>(d.depth.palette.steps(code) != 0);
      if (d.depth.uniformLabel == 0) {
        sum += leafLabel(d.leafBytes, link, mask.count(), mask.rank(c));
      }
    }
  });
  return sum;
}

// Where the seeds' cells are, and at every smaller scale, for spacings are forged too. Made once: a
// shell takes a hundred times as long as a query.
const PointShell& shellOfAllScales() {
  static const PointShell shell = [] {
    std::mt19937 rng(1);
    std::vector<Eigen::Vector3d> points;
    for (int n = 0; n < 240; ++n) {
      const double scale = 0.03 * std::pow(0.5, n % 3 == 0 ? n / 6 : 0);
      Eigen::Vector3d p;
      for (int a = 0; a < 3; ++a) p[a] = scale * (static_cast<double>(rng() % 1201) / 1000 - 0.1);
      points.push_back(p);
    }
    return PointShell::fromPoints(
               points, std::vector<Eigen::Vector3d>(points.size(), Eigen::Vector3d::UnitX()))
        .value();
  }();
  return shell;
}

// Two of the ways to ask, by `choice`.
void query(const VoxelTree& tree, std::size_t choice) {
  const PointShell* shell = &shellOfAllScales();
  std::vector<Contact> out(shell->size());
  const QueryOptions all[] = {{},
                              {QueryMethod::Paper},
                              {QueryMethod::BruteForce},
                              {QueryMethod::Paper, false, false, true, 1},
                              {QueryMethod::Hierarchy, true, true, false, 2, 20}};
  for (const std::size_t which : {choice % 3, 3 + choice % 2}) {
    const QueryOptions& options = all[which];
    ContactFinder finder(tree, *shell, options);
    const QueryResult result = finder.find(Eigen::Isometry3d::Identity(), out);
    require(result.contactCount <= out.size(), "contacts fit");
    static_cast<void>(finder.findPacked(Eigen::Isometry3d::Identity()));
  }
}

void use(const VoxelTree& tree, std::size_t choice) {
  const VoxelTree::Data& d = tree.data();
  std::size_t budget = 200000;
  if (d.bits == 1) walk<1>(d, d.levels, 0, budget);
  if (d.bits == 2) walk<2>(d, d.levels, 0, budget);
  if (d.bits == 3) walk<3>(d, d.levels, 0, budget);
  query(tree, choice);
  if (choice % 8 != 0) return;
  const std::string again = treeToCache(tree, kSeedSource);
  require(treeFromCache(again, kSeedSource).has_value(), "what was accepted is accepted again");
}

void put(std::uint8_t* data, std::size_t at, std::uint64_t value, std::size_t bytes) {
  std::memcpy(data + at, &value, bytes);
}

// As if a careful writer had written these bytes: nothing but the content is left to refuse.
void fixHeader(std::uint8_t* data, std::size_t size) {
  static const std::string good = seedTrees().front();
  std::memcpy(data, good.data(), 24);
  put(data, 24, size - kHeader, 8);
  put(data, 32, XXH3_64bits(data + kHeader, size - kHeader), 8);
}

}  // namespace
}  // namespace palpate

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto tree = treeFromCache(bytes, kSeedSource);
  const std::size_t choice = size > 0 ? data[size - 1 - size / 3] : 0U;
  if (tree) use(*tree, choice);
  require(tree || tree.error().kind == ErrorKind::InputRefused, "a file is refused as an input");
  // The same file mapped, where arrays are views of it.
  if (size == 0 || choice % 4 != 1) return 0;
  const int file = memfd_create("tree", 0);
  if (file < 0) return 0;
  if (write(file, data, size) == static_cast<ssize_t>(size)) {
    const auto mapped = loadTreeCache("/proc/self/fd/" + std::to_string(file), kSeedSource);
    require(mapped.has_value() == tree.has_value(), "mapped or copied, the answer is one");
    if (mapped) query(*mapped, choice);
  }
  close(file);
  return 0;
}

// Changes the content and mends the checksum, which no mutation would guess; one in sixteen goes
// out as it is.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t maxSize, unsigned seed) {
  using namespace palpate;
  std::mt19937 rng(seed);
  if (size < kHeader + 64) {
    static const std::vector<std::string> seeds = seedTrees();
    const std::string& some = seeds[rng() % seeds.size()];
    if (some.size() > maxSize) return LLVMFuzzerMutate(data, size, maxSize);
    std::memcpy(data, some.data(), some.size());
    size = some.size();
  }
  if (rng() % 16 == 0) return LLVMFuzzerMutate(data, size, maxSize);
  const std::size_t body = size - kHeader;
  const int changes = 1 + static_cast<int>(rng() % 4);
  for (int c = 0; c < changes; ++c) {
    // Half in the fields before the arrays; values that matter where a number is.
    const std::size_t range = rng() % 2 == 0 ? std::min<std::size_t>(body - 8, 420) : body - 8;
    const std::size_t at = kHeader + rng() % range;
    switch (rng() % 6) {
      case 0:
        data[at] = static_cast<std::uint8_t>(rng());
        break;
      case 1:
        data[at] ^= static_cast<std::uint8_t>(1U << (rng() % 8));
        break;
      case 2: {
        constexpr std::uint32_t kEdge[] = {0,          1,          2,          63,
                                           64,         0x7FFFFFFF, 0x80000000, 0xFFFFFFFF,
                                           0xBFFFFFFF, 0xC0000000, 0x3FFFFFFF, 0x3FFFFFF2};
        put(data, at & ~std::size_t{3}, kEdge[rng() % std::size(kEdge)], 4);
        break;
      }
      case 3: {
        // Of a word that was there, a little more or less.
        std::uint32_t word = 0;
        std::memcpy(&word, data + (at & ~std::size_t{3}), 4);
        put(data, at & ~std::size_t{3}, word + rng() % 9 - 4, 4);
        break;
      }
      case 4: {
        const double value = std::ldexp(1.0, static_cast<int>(rng() % 2100) - 1050);
        std::memcpy(data + at, &value, 8);
        break;
      }
      default: {
        const std::size_t part = std::min<std::size_t>(1 + rng() % 32, size - at);
        static_cast<void>(LLVMFuzzerMutate(data + at, part, part));
        break;
      }
    }
  }
  if (rng() % 12 == 0) size = kHeader + 64 + rng() % (body - 63);
  fixHeader(data, size);
  return size;
}
