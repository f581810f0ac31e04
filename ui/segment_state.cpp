#include "ui/segment_state.h"

#include "ui/icons.h"

namespace palpate::ui {
namespace {

std::vector<Eigen::Vector3d> points(const SegmentPanelState& state) {
  std::vector<Eigen::Vector3d> out;
  for (const auto& pick : state.picks) out.push_back(pick.at_mm);
  return out;
}

ThresholdRange range(const SegmentPanelState& state) {
  return {static_cast<double>(state.low), static_cast<double>(state.high)};
}

std::optional<LabelTool> islandsOf(const SegmentPanelState& state) {
  tool::Islands tool;
  tool.keep = static_cast<tool::Islands::Keep>(state.islands);
  tool.count = static_cast<std::size_t>(state.islandCount);
  tool.minMm3 = static_cast<double>(state.islandMm3);
  using Keep = tool::Islands::Keep;
  if (tool.keep == Keep::Picked || tool.keep == Keep::NotPicked) {
    if (state.picks.empty()) return {};
    tool.picks_mm = points(state);
  }
  return tool;
}

std::optional<LabelTool> splitOf(const SegmentPanelState& state) {
  tool::Split tool;
  tool.by = state.byEdges ? tool::Split::By::Edges : tool::Split::By::Brightness;
  tool.radius_mm = 2.0;
  std::size_t seeded = 0;
  for (std::size_t p = 0; p < state.parts.size(); ++p) {
    tool::Split::Seeds seeds{p == 0 ? state.label : state.parts[p], {}};
    for (const auto& pick : state.picks) {
      if (pick.part == p) seeds.points_mm.push_back(pick.at_mm);
    }
    if (seeds.points_mm.empty()) continue;
    if (seeds.label.empty()) return {};
    tool.seeds.push_back(std::move(seeds));
    ++seeded;
  }
  if (seeded < 2) return {};
  return tool;
}

std::optional<LabelTool> boxOf(const SegmentPanelState& state) {
  if (!state.box_mm) return {};
  const auto& [a, b] = *state.box_mm;
  return tool::Box{a.cwiseMin(b), a.cwiseMax(b), state.keepInside, state.allLabels};
}

std::optional<LabelTool> toolOf(const SegmentPanelState& state) {
  switch (state.kind) {
    case ToolKind::Threshold:
      return tool::Threshold{range(state), state.largest, static_cast<double>(state.minMm3)};
    case ToolKind::Grow:
      if (state.picks.empty()) return {};
      return tool::GrowRegion{points(state), range(state), static_cast<double>(state.reachMm)};
    case ToolKind::Islands:
      return islandsOf(state);
    case ToolKind::FillHoles:
      return tool::FillHoles{static_cast<double>(state.holeMm3)};
    case ToolKind::Margin:
      return tool::Margin{static_cast<tool::Margin::Operation>(state.margin),
                          static_cast<double>(state.marginMm)};
    case ToolKind::Smooth:
      return tool::Smooth{static_cast<double>(state.smoothMm), state.keepThin};
    case ToolKind::Box:
      return boxOf(state);
    case ToolKind::Split:
      return splitOf(state);
    case ToolKind::Combine:
      if (state.other.empty()) return {};
      return tool::Combine{static_cast<tool::Combine::Operation>(state.combine), state.other,
                           static_cast<double>(state.grownMm)};
    case ToolKind::Brush:
    case ToolKind::Eraser:
    case ToolKind::Scissors:
      return {};
  }
  return {};
}

}  // namespace

void SegmentPanelState::forgetPicks() {
  picks.clear();
  missed = false;
  box_mm.reset();
}

bool SegmentPanelState::abandon() {
  const bool draws = drawingIn.has_value();
  if (!draws && picks.empty() && !box_mm) return false;
  forget();
  abandoned = draws;
  return true;
}

void SegmentPanelState::forget() {
  forgetPicks();
  stroke_mm.clear();
  outline.clear();
  drawingIn.reset();
}

const ToolWords& toolWords(ToolKind kind) {
  static constexpr std::array<ToolWords, kTools> words{{
      {icon::kMagic, "Threshold", "Threshold: everything in a range of values"},
      {icon::kLeaf, "Grow", "Grow: what is connected to a click"},
      {icon::kCubes, "Islands", "Islands: keep or drop separate parts"},
      {icon::kCircle, "Fill holes", "Fill holes: what the label encloses"},
      {icon::kExpand, "Margin", "Margin: grow, shrink, open, close by millimetres"},
      {icon::kTint, "Smooth", "Smooth: round what is rough, keep thin bone"},
      {icon::kBrush, "Paint", "Paint: a brush for slices"},
      {icon::kEraser, "Erase", "Erase: a brush that takes away"},
      {icon::kScissors, "Scissors", "Scissors: cut what you draw around"},
      {icon::kCrop, "Box", "Box: crop to a region, or cut one away"},
      {icon::kFork, "Split", "Split: name parts that hang together, by seeds"},
      {icon::kPlus, "Combine", "Combine: label arithmetic"},
  }};
  return words[static_cast<std::size_t>(kind)];
}

Gesture gestureOf(const SegmentPanelState& state) {
  using Keep = tool::Islands::Keep;
  switch (state.kind) {
    case ToolKind::Grow:
    case ToolKind::Split:
      return Gesture::Pick;
    case ToolKind::Islands: {
      const auto keep = static_cast<Keep>(state.islands);
      return keep == Keep::Picked || keep == Keep::NotPicked ? Gesture::Pick : Gesture::None;
    }
    case ToolKind::Brush:
    case ToolKind::Eraser:
      return Gesture::Stroke;
    case ToolKind::Scissors:
      return Gesture::Outline;
    case ToolKind::Box:
      return Gesture::Rectangle;
    default:
      return Gesture::None;
  }
}

LabelStep bareStep(const SegmentPanelState& state) {
  LabelStep step;
  step.label = state.label;
  step.limits.overOthers = state.overOthers;
  if (state.onlyRange) step.limits.only = range(state);
  return step;
}

std::optional<LabelStep> stepOf(const SegmentPanelState& state) {
  auto tool = toolOf(state);
  if (!tool) return {};
  LabelStep step = bareStep(state);
  if (state.kind == ToolKind::Threshold) {
    step.label = state.name;
    step.limits = {};
  } else if (state.kind == ToolKind::Grow) {
    step.limits.only.reset();
  }
  if (step.label.empty()) return {};
  step.tool = std::move(*tool);
  return step;
}

}  // namespace palpate::ui
