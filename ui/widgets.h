#pragma once
/// The few controls the window is made of, in one look, each registered by its label so that a
/// script can find it.

#include <imgui.h>

#include <array>
#include <map>
#include <string>
#include <vector>

#include "ui/actions.h"
#include "ui/fonts.h"
#include "ui/layout.h"
#include "ui/theme.h"

namespace palpate::ui {

/// What every part of the window draws with; lives for a frame.
struct Painter {
  const Theme& theme;
  const Fonts& fonts;
  float scale = 1.0F;
  Actions& actions;
  std::map<std::string, Rect>& items;

  [[nodiscard]] float px(float v) const { return v * scale; }
  /// Remembers where the last item is.
  void note(const std::string& label) const;
};

enum class Emphasis { Quiet, Normal, Primary, Danger };

/// A button of the panel's control height; `width` 0: as wide as its words, below 0: to the edge.
bool button(const Painter& paint, const char* icon, const std::string& label,
            Emphasis emphasis = Emphasis::Normal, float width = -1.0F, bool enabled = true,
            const char* tooltip = nullptr);
/// A square with an icon; the label is its tooltip.
bool iconButton(const Painter& paint, const char* icon, const std::string& label, bool on = false,
                bool enabled = true);
/// Exactly one of several; returns the chosen index, which may be a new one.
std::size_t segmented(const Painter& paint, const char* id, const std::vector<std::string>& labels,
                      std::size_t chosen, bool enabled = true);
/// A switch with its words on the left: the label, or what is said in its place, 13 px.
bool toggle(const Painter& paint, const std::string& label, bool& on, bool enabled = true,
            const std::string& instead = {});

/// A key and a value over a thin track; true when the value changed.
bool slider(const Painter& paint, const std::string& label, int& value, int low, int high);

void heading(const Painter& paint, const std::string& text);   ///< Of a panel, 20 px.
void section(const Painter& paint, const std::string& text);   ///< Of a part, 13 px, secondary.
void sentence(const Painter& paint, const std::string& text);  ///< 13 px, secondary, wrapped.
void keyValue(const Painter& paint, const std::string& key, const std::string& value);
/// An icon, and words that wrap, on a raised ground.
void notice(const Painter& paint, MessageModel::Kind kind, const std::string& text);
void progressBar(const Painter& paint, double fraction, float height);
void space(const Painter& paint, float pixels);
/// Text cut with an ellipsis to a width.
[[nodiscard]] std::string shortened(const std::string& text, ImFont* font, float width);

}  // namespace palpate::ui
