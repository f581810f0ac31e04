#pragma once
/// What the Segment panel remembers: the chosen tool, its settings, and what was picked or drawn so
/// far; and the step that these make.

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "imaging/segment/tools.h"
#include "ui/layout.h"
#include "ui/model.h"

namespace palpate::ui {

enum class ToolKind : std::uint8_t {
  Threshold,
  Grow,
  Islands,
  FillHoles,
  Margin,
  Smooth,
  Brush,
  Eraser,
  Scissors,
  Box,
  Split,
  Combine
};
inline constexpr std::size_t kTools = 12;

struct SegmentPanelState {
  ToolKind kind = ToolKind::Threshold;
  std::string label;          ///< What the tools work on.
  std::uint8_t value = 0;     ///< Its value: the label stays chosen when its name changes.
  std::string name = "bone";  ///< Of the label that a threshold makes.
  std::size_t preset = 0;
  float low = 226, high = 3071;        ///< Threshold, region growing, and "only these values".
  std::optional<std::size_t> dragged;  ///< End of the range that the mouse has: 0 low, 1 high.
  bool largest = false;
  float minMm3 = 0;

  float reachMm = 0;
  int islands = 0;  ///< tool::Islands::Keep
  int islandCount = 1;
  float islandMm3 = 100;
  float holeMm3 = 0;
  int margin = 3;  ///< tool::Margin::Operation
  float marginMm = 1.5F;
  float smoothMm = 1.0F;
  bool keepThin = true;
  float brushMm = 4.0F;
  bool sphere = false;
  bool keepInside = false;  ///< Of scissors and box.
  bool throughAll = true;   ///< Scissors in a slice: all slices, else only this one.
  bool allLabels = false;   ///< Box.
  int combine = 0;          ///< tool::Combine::Operation
  std::string other;
  float grownMm = 0;
  bool byEdges = false;
  std::vector<std::string> parts;  ///< Labels of a split; the first is the label itself.
  std::size_t part = 0;            ///< That a click puts a seed of.
  /// Of the parts, as the split will draw them; packed as Dear ImGui does.
  std::vector<std::uint32_t> partColours;

  std::uint8_t editing = 0;  ///< Label whose name, colour and material are shown; 0: none.
  std::string editName;

  bool overOthers = false, onlyRange = false;
  bool preview = true;

  struct Pick {
    Eigen::Vector3d at_mm;
    std::size_t part = 0;
  };
  std::vector<Pick> picks;
  bool missed = false;  ///< The last click was beside the label.
  using Corners = std::array<Eigen::Vector3d, 2>;
  std::optional<Corners> box_mm;     ///< Not sorted.
  std::optional<Corners> boxBefore;  ///< The drag that goes on: a mere click changes nothing.
  /// What the drag moves along each axis of P: a corner's side, both (a new box), or nothing.
  enum class BoxGrip : std::uint8_t { First, Second, Both, None };
  std::array<BoxGrip, 3> boxGrip{BoxGrip::Both, BoxGrip::Both, BoxGrip::Both};

  /// A stroke or an outline being drawn, until the button is let go.
  std::optional<View> drawingIn;
  std::vector<Eigen::Vector3d> stroke_mm;
  std::vector<Eigen::Vector2d> outline;  ///< Screen, framebuffer pixels.
  bool abandoned = false;  ///< Escape, until the button is let go: it draws nothing more.

  float footer = 0.0F;  ///< Height of what stays in reach below the settings, as last drawn.
  std::filesystem::path initialisedFor;
  std::string sentKey;     ///< Of the step whose preview was asked for last.
  std::string wantedKey;   ///< Of the step as it is set now.
  std::string applied;     ///< Of the step that was applied last: no preview of it again.
  double changedAt = 0.0;  ///< When wantedKey changed, seconds.

  void forget();       ///< Picks, box, strokes.
  void forgetPicks();  ///< Picks and box; what is being drawn goes on.
  /// What is being drawn; else picks and box. False: there was nothing.
  bool abandon();
};

struct ToolWords {
  const char* icon;
  const char* title;
  const char* tooltip;
};
[[nodiscard]] const ToolWords& toolWords(ToolKind kind);

/// What the left mouse button does in the views.
enum class Gesture : std::uint8_t { None, Pick, Stroke, Outline, Rectangle };
[[nodiscard]] Gesture gestureOf(const SegmentPanelState& state);

/// The step that the settings and picks make, for tools with a preview; nothing while something is
/// missing. Brush and scissors make theirs when the button is let go (ui/view_edit.h).
[[nodiscard]] std::optional<LabelStep> stepOf(const SegmentPanelState& state);
/// Label and limits, without a tool.
[[nodiscard]] LabelStep bareStep(const SegmentPanelState& state);

}  // namespace palpate::ui
