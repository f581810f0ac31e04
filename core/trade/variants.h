#pragma once
/// A prepared scene at other settings. What an earlier variant has built is used again.

#include <memory>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/simulation/prepared_scene.h"
#include "core/trade/options.h"

namespace palpate {

/// Loose bodies are left out: what is measured is the instrument on the anatomy; so are the levels
/// of a governor. The base outlives it.
class Variants {
 public:
  explicit Variants(const PreparedScene& base);

  [[nodiscard]] Result<std::shared_ptr<const PreparedScene>> at(const TradeSetting& setting);
  /// @param spacing  m.
  [[nodiscard]] Result<std::shared_ptr<const PointShell>> shellAt(double spacing);
  /// m, of the setting's shell.
  [[nodiscard]] double spacingOf(const SimulationSetting& setting) const noexcept;

 private:
  struct Built {
    int coarsening = 1;
    std::shared_ptr<const LabelGrid> labels;
    std::shared_ptr<const VoxelTree> tree;
  };
  [[nodiscard]] Result<Built> treeOf(const TreeOptions& options, int coarsening);

  const PreparedScene& base_;
  std::vector<std::uint8_t> felt_;
  std::shared_ptr<const LabelGrid> reachable_;  ///< What trees are built of, as the base's was.
  std::vector<Built> trees_;
  std::vector<std::pair<double, std::shared_ptr<const PointShell>>> shells_;
};

}  // namespace palpate
