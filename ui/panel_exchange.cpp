/// Labels to files of other programs and from them: two dialogs, and the question before a file is
/// replaced.

#include <imgui.h>

#include <imgui_stdlib.h>  // after imgui.h: it does not include it itself

#include <algorithm>
#include <cctype>

#include "ui/icons.h"
#include "ui/panels.h"

namespace palpate::ui {
namespace {

namespace fs = std::filesystem;
using Dialog = ExchangePanelState::Dialog;

constexpr ImGuiWindowFlags kDialog = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
                                     ImGuiWindowFlags_AlwaysAutoResize;
constexpr std::array<ExchangeFormat, 6> kFormats{ExchangeFormat::DicomSeg,  ExchangeFormat::Nrrd,
                                                 ExchangeFormat::MetaImage, ExchangeFormat::Stl,
                                                 ExchangeFormat::Ply,       ExchangeFormat::Obj};

const char* wordsOf(ExchangeFormat format) {
  switch (format) {
    case ExchangeFormat::DicomSeg:
      return "A DICOM segmentation, for an archive. It holds the case's pseudonym and no name.";
    case ExchangeFormat::Nrrd:
      return "A label volume that 3D Slicer opens with names and colours.";
    case ExchangeFormat::MetaImage:
      return "A label volume of numbers alone, without names.";
    case ExchangeFormat::Stl:
    case ExchangeFormat::Ply:
    case ExchangeFormat::Obj:
      return "The surface of one label, in patient coordinates (LPS) and millimetres. A surface of "
             "a face is a face.";
  }
  return "";
}

/// Opens what was asked for, once; true while it is open, in a card in the middle of the window.
bool beginDialog(const Painter& paint, const Rect& window, const char* id, bool opens,
                 float width) {
  if (opens) ImGui::OpenPopup(id);
  if (!ImGui::IsPopupOpen(id)) return false;
  const float room = std::min(paint.px(width), window.w - paint.px(24.0F));
  ImGui::SetNextWindowPos({window.x + 0.5F * window.w, window.y + 0.5F * window.h},
                          ImGuiCond_Always, {0.5F, 0.5F});
  ImGui::SetNextWindowSizeConstraints({room, 0.0F}, {room, window.h - paint.px(24.0F)});
  ImGui::PushStyleColor(ImGuiCol_PopupBg, paint.theme.panel);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {paint.px(16.0F), paint.px(14.0F)});
  const bool open = ImGui::BeginPopupModal(id, nullptr, kDialog);
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
  return open;
}

/// A label's name as a part of a file's.
std::string fileNameOf(const std::string& label) {
  std::string name;
  for (const char c : label) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = byte >= 0x80 || std::isalnum(byte) != 0 || c == '-' || c == '_' || c == '.';
    name += plain ? c : '-';
  }
  return name;
}

void proposePath(const Model& model, ExchangePanelState& state) {
  const std::string what = state.label.empty() ? "labels" : fileNameOf(state.label);
  state.path = (model.segment.exchange.folder /
                (model.openCase.fileName + "-" + what + exchangeEnding(state.format)))
                   .string();
}

/// The same name with the ending of the chosen format.
void changeEnding(ExchangePanelState& state) {
  fs::path path = state.path;
  if (!exportFormat(path)) {
    state.path += exchangeEnding(state.format);
    return;
  }
  path.replace_extension();
  if (path.extension() == ".seg") path.replace_extension();
  state.path = path.string() + exchangeEnding(state.format);
}

void chooseWhat(const Painter& paint, const Model& model, ExchangePanelState& state,
                const std::string& chosen) {
  const auto& labels = model.segment.labels;
  const auto there = [&labels](const std::string& name) {
    return std::any_of(labels.begin(), labels.end(),
                       [&name](const LabelRow& row) { return row.name == name; });
  };
  const std::string before = state.label;
  if (!there(state.label)) state.label.clear();
  if (isSurface(state.format) && state.label.empty()) {
    state.label = there(chosen) || labels.empty() ? chosen : labels.front().name;
  }
  const std::string all = "All labels (" + std::to_string(labels.size()) + ")";
  const std::string shown = state.label.empty() ? all : state.label;
  ImGui::SetNextItemWidth(-1.0F);
  if (ImGui::BeginCombo("##what", shown.c_str())) {
    if (!isSurface(state.format)) {
      if (ImGui::Selectable(all.c_str(), state.label.empty())) state.label.clear();
      paint.note("All labels");
    }
    for (const LabelRow& row : labels) {
      ImGui::PushID(row.value);
      if (ImGui::Selectable(row.name.c_str(), row.name == state.label)) state.label = row.name;
      paint.note("Only " + row.name);
      ImGui::PopID();
    }
    ImGui::EndCombo();
  }
  paint.note("What to export");
  if (before != state.label && !state.named) proposePath(model, state);
}

void chooseFormat(const Painter& paint, const Model& model, ExchangePanelState& state) {
  const ExchangeFormat before = state.format;
  for (std::size_t line = 0; line < 2; ++line) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < 3; ++i) {
      names.emplace_back(exchangeFormatName(kFormats[3 * line + i]));
    }
    const auto at = std::find(kFormats.begin(), kFormats.end(), state.format) - kFormats.begin();
    const auto here = static_cast<std::size_t>(at);
    const std::size_t on = here / 3 == line ? here % 3 : names.size();
    const std::size_t now = segmented(paint, line == 0 ? "volumes" : "surfaces", names, on);
    if (now != on) state.format = kFormats[3 * line + now];
  }
  if (before == state.format) return;
  // A surface is of one label; back again it is all of them, as before.
  if (isSurface(before) && !isSurface(state.format)) state.label.clear();
  if (state.named) {
    changeEnding(state);
  } else {
    proposePath(model, state);
  }
}

/// The folder's own list; gives the file that was clicked.
std::optional<fs::path> drawFolder(const Painter& paint, const ExchangeModel& exchange) {
  std::optional<fs::path> chosen;
  if (iconButton(paint, icon::kUp, "Up one folder")) {
    paint.actions.push_back(act::BrowseLabels{exchange.folder.parent_path()});
  }
  ImGui::SameLine();
  ImGui::PushFont(paint.fonts.secondary);
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored(
      paint.theme.secondary, "%s",
      shortened(exchange.folder.string(), paint.fonts.secondary, ImGui::GetContentRegionAvail().x)
          .c_str());
  ImGui::PopFont();
  ImGui::BeginChild("files", {0.0F, paint.px(168.0F)}, false);
  for (const DirectoryRow& entry : exchange.entries) {
    ImGui::PushID(entry.name.c_str());
    const std::string text =
        std::string(entry.folder ? icon::kFolder : icon::kFile) + "  " +
        shortened(entry.name, paint.fonts.body, ImGui::GetContentRegionAvail().x - paint.px(28.0F));
    if (ImGui::Selectable(text.c_str(), false, 0, {0.0F, paint.px(22.0F)})) {
      const fs::path path = exchange.folder / entry.name;
      if (entry.folder) {
        paint.actions.push_back(act::BrowseLabels{path});
      } else {
        chosen = path;
      }
    }
    paint.note("File " + entry.name);
    ImGui::PopID();
  }
  if (exchange.entries.empty()) sentence(paint, "No folder and no file of labels is in here.");
  ImGui::EndChild();
  return chosen;
}

/// A path with Browse beside it; true on Return.
bool drawPath(const Painter& paint, const char* hint, std::string& path, bool& browsing,
              bool& edited) {
  const float browse = paint.px(96.0F);
  ImGui::SetNextItemWidth(-(browse + ImGui::GetStyle().ItemSpacing.x));
  const bool entered =
      ImGui::InputTextWithHint("##file", hint, &path, ImGuiInputTextFlags_EnterReturnsTrue);
  edited = ImGui::IsItemEdited();
  paint.note("Path of the file");
  ImGui::SameLine();
  if (button(paint, icon::kFolderOpen, "Browse", Emphasis::Normal, browse)) {
    browsing = !browsing;
    if (browsing) paint.actions.push_back(act::BrowseLabels{});
  }
  return entered;
}

/// Cancel and what the dialog is for; true where that was pressed.
bool drawButtons(const Painter& paint, const char* icon, const char* does, bool enabled) {
  space(paint, 2.0F);
  const float half = 0.5F * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  if (button(paint, nullptr, "Cancel", Emphasis::Normal, half)) ImGui::CloseCurrentPopup();
  ImGui::SameLine();
  return button(paint, icon, does, Emphasis::Primary, half, enabled);
}

void drawExport(const Painter& paint, const Model& model, ExchangePanelState& state,
                const std::string& chosen) {
  heading(paint, "Export labels");
  chooseFormat(paint, model, state);
  sentence(paint, wordsOf(state.format));
  chooseWhat(paint, model, state, chosen);
  bool edited = false;
  const bool entered = drawPath(paint, "File to write", state.path, state.browsing, edited);
  state.named = state.named || edited;
  if (state.browsing) {
    const fs::path folder = model.segment.exchange.folder;
    if (const auto file = drawFolder(paint, model.segment.exchange)) {
      state.path = file->string();
      state.named = edited = true;
    } else if (folder != state.shownFolder) {
      state.path = (folder / fs::path(state.path).filename()).string();
    }
    state.shownFolder = folder;
  }
  const auto typed = exportFormat(state.path);
  if (edited && typed) state.format = *typed;  // the ending says it
  const bool fits = !fs::path(state.path).filename().empty() && !model.segment.labels.empty();
  if ((drawButtons(paint, icon::kSave, "Export", fits) || entered) && fits) {
    if (!typed) changeEnding(state);
    ExportWish wish{state.path, {}, false};
    if (!state.label.empty()) wish.labels.push_back(state.label);
    paint.actions.push_back(act::ExportLabels{wish});
    ImGui::CloseCurrentPopup();
  }
}

void drawJoin(const Painter& paint, const Model& model, ExchangePanelState& state) {
  heading(paint, "Labels from a file");
  sentence(paint,
           "A DICOM segmentation, a label volume (.nrrd, .mha) or a closed surface (.stl, .ply, "
           ".obj) on this scan. Labels of the same name are replaced, others are added; Undo takes "
           "them back.");
  bool edited = false;
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  const bool entered = drawPath(paint, "File to read", state.from, state.browsing, edited);
  if (state.browsing) {
    if (const auto file = drawFolder(paint, model.segment.exchange)) state.from = file->string();
  }
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - paint.px(40.0F));
  ImGui::InputTextWithHint("##only", "Name: as in the file", &state.only);
  paint.note("Name in the file");
  if (ImGui::IsItemHovered()) {
    ImGui::SetTooltip("Renames the file's one label, or chooses one of several.");
  }
  ImGui::SameLine();
  if (const AnatomyRow* anatomy = chooseAnatomy(paint, model.segment)) state.only = anatomy->name;
  const bool fits = !state.from.empty() && !model.job.active;
  if ((drawButtons(paint, icon::kImport, "Take the labels", fits) || entered) && fits) {
    paint.actions.push_back(act::JoinLabels{state.from, state.only});
    ImGui::CloseCurrentPopup();
  }
}

void drawQuestion(const Painter& paint, const ExportWish& wish, ExchangePanelState& state) {
  heading(paint, "A file of that name is there");
  ImGui::PushFont(paint.fonts.secondary);
  ImGui::TextWrapped("%s", wish.file.c_str());
  ImGui::PopFont();
  sentence(paint, "What it holds now would be lost.");
  space(paint, 2.0F);
  const float half = 0.5F * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  if (button(paint, nullptr, "Another name", Emphasis::Primary, half)) {
    paint.actions.push_back(act::KeepFile{});
    state.wanted = Dialog::Export;
    ImGui::CloseCurrentPopup();
  }
  ImGui::SameLine();
  if (button(paint, nullptr, "Replace it", Emphasis::Danger, half)) {
    paint.actions.push_back(act::ExportLabels{wish});
    ImGui::CloseCurrentPopup();
  }
}

}  // namespace

void drawExchange(const Painter& paint, const Rect& window, const Model& model,
                  ExchangePanelState& state, const std::string& chosen) {
  const Dialog wanted = std::exchange(state.wanted, Dialog::None);
  if (wanted == Dialog::Export && !state.named) proposePath(model, state);
  if (wanted != Dialog::None) state.browsing = false;
  if (beginDialog(paint, window, "##export", wanted == Dialog::Export, 480.0F)) {
    drawExport(paint, model, state, chosen);
    ImGui::EndPopup();
  }
  if (beginDialog(paint, window, "##join", wanted == Dialog::Join, 480.0F)) {
    drawJoin(paint, model, state);
    ImGui::EndPopup();
  }
  const auto& asks = model.segment.exchange.asks;
  const bool opens = asks && !ImGui::IsPopupOpen("##replace");
  if (beginDialog(paint, window, "##replace", opens && !state.asked, 420.0F)) {
    if (asks) {
      drawQuestion(paint, *asks, state);
    } else {
      ImGui::CloseCurrentPopup();
    }
    ImGui::EndPopup();
  } else if (asks && state.asked) {
    paint.actions.push_back(act::KeepFile{});  // closed by Escape
  }
  state.asked = asks.has_value();
}

}  // namespace palpate::ui
