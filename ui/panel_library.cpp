#include <imgui.h>

#include <imgui_stdlib.h>  // after imgui.h: it does not include it itself

#include "ui/icons.h"
#include "ui/panels.h"

namespace palpate::ui {
namespace {

/// A row that can be clicked: title, and a quieter second line.
bool row(const Painter& paint, const char* icon, const std::string& title,
         const std::string& detail, bool on, bool enabled = true) {
  const float height = paint.px(detail.empty() ? 30.0F : 44.0F);
  const float width = ImGui::GetContentRegionAvail().x;
  ImGui::BeginDisabled(!enabled);
  const bool pressed = ImGui::InvisibleButton(title.c_str(), {width, height});
  ImGui::EndDisabled();
  paint.note(title);
  const ImVec2 a = ImGui::GetItemRectMin();
  const ImVec2 b = ImGui::GetItemRectMax();
  ImDrawList* list = ImGui::GetWindowDrawList();
  if (on || (enabled && ImGui::IsItemHovered())) {
    list->AddRectFilled(a, b, packed(on ? paint.theme.raised : paint.theme.hover),
                        paint.px(Measures::kCorner));
  }
  const float alpha = enabled ? 1.0F : 0.5F;
  const float left = a.x + paint.px(32.0F);
  const float room = b.x - left - paint.px(6.0F);
  ImFont* small = paint.fonts.secondary;
  list->AddText({a.x + paint.px(8.0F), a.y + paint.px(6.0F)},
                packed(on ? paint.theme.accent : paint.theme.secondary, alpha), icon);
  list->AddText({left, a.y + paint.px(6.0F)}, packed(paint.theme.text, alpha),
                shortened(title, paint.fonts.body, room).c_str());
  if (!detail.empty()) {
    list->AddText(small, small->FontSize, {left, a.y + paint.px(24.0F)},
                  packed(paint.theme.secondary, alpha), shortened(detail, small, room).c_str());
  }
  return pressed && enabled;
}

void drawBrowser(const Painter& paint, const Model& model, LibraryPanelState& state) {
  const LibraryModel& library = model.library;
  ImGui::PushFont(paint.fonts.secondary);
  ImGui::PushStyleColor(ImGuiCol_Text, paint.theme.secondary);
  const std::string where = library.directory.string();
  ImGui::TextUnformatted(
      shortened(where, paint.fonts.secondary, ImGui::GetContentRegionAvail().x).c_str());
  ImGui::PopStyleColor();
  ImGui::PopFont();
  if (iconButton(paint, icon::kUp, "Up one folder")) {
    paint.actions.push_back(act::Browse{library.directory.parent_path()});
  }
  ImGui::SameLine();
  if (button(paint, icon::kImport, "Import this folder", Emphasis::Normal, -1.0F)) {
    state.path = where;
    paint.actions.push_back(act::Import{library.directory});
  }
  ImGui::BeginChild("entries", {0.0F, paint.px(190.0F)}, false);
  for (const DirectoryRow& entry : library.entries) {
    if (!row(paint, entry.folder ? icon::kFolder : icon::kFile, entry.name, "", false)) continue;
    const auto chosen = library.directory / entry.name;
    if (entry.folder) {
      paint.actions.push_back(act::Browse{chosen});
    } else {
      state.path = chosen.string();
      paint.actions.push_back(act::Import{chosen});
    }
  }
  if (library.entries.empty()) sentence(paint, "Nothing in this folder can be read.");
  ImGui::EndChild();
}

void drawKeepNames(const Painter& paint, const LibraryModel& library) {
  bool keep = library.keepNames;
  if (toggle(paint, "Keep the patient's name", keep)) {
    paint.actions.push_back(act::KeepNames{keep});
  }
  sentence(paint, keep ? "The case will hold the name and identifier: mind who may see it."
                       : "The case gets a pseudonym; name and identifier stay behind.");
}

void drawRepair(const Painter& paint, const LibraryModel& library) {
  if (library.repairPath.empty()) return;
  notice(paint, MessageModel::Kind::Warning,
         library.repairReason + " It can be resampled to a regular grid; the case then says so.");
  const float half = 0.5F * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  if (button(paint, icon::kCheck, "Repair", Emphasis::Normal, half)) {
    paint.actions.push_back(act::ImportRepaired{true});
  }
  ImGui::SameLine();
  if (button(paint, icon::kClose, "Leave it", Emphasis::Quiet, half)) {
    paint.actions.push_back(act::ImportRepaired{false});
  }
}

void drawImport(const Painter& paint, const Model& model, LibraryPanelState& state) {
  section(paint, "IMPORT A SCAN");
  ImGui::SetNextItemWidth(-1.0F);
  const bool entered = ImGui::InputTextWithHint("##path", "Folder or file of the scan", &state.path,
                                                ImGuiInputTextFlags_EnterReturnsTrue);
  paint.note("Path of the scan");
  const bool idle = !model.job.active;
  const float half = 0.5F * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  const bool pressed =
      button(paint, icon::kImport, "Import", Emphasis::Normal, half, idle && !state.path.empty());
  ImGui::SameLine();
  if (button(paint, icon::kFolderOpen, "Browse", Emphasis::Normal, half)) {
    state.browsing = !state.browsing;
    if (state.browsing) paint.actions.push_back(act::Browse{model.library.directory});
  }
  if ((entered || pressed) && idle && !state.path.empty()) {
    paint.actions.push_back(act::Import{state.path});
  }
  drawKeepNames(paint, model.library);
  drawRepair(paint, model.library);
  if (state.browsing) drawBrowser(paint, model, state);
}

}  // namespace

void drawLibraryPanel(const Painter& paint, const Model& model, LibraryPanelState& state) {
  heading(paint, "Library");
  if (!model.openCase.open && model.library.recent.empty()) {
    sentence(
        paint,
        "Start with the demo, a real CT of a head, or import a scan of your own: a folder from "
        "the hospital's disc is enough.");
  }
  if (model.library.demoAvailable &&
      button(paint, icon::kCube, "Open the demo case",
             model.openCase.open ? Emphasis::Normal : Emphasis::Primary, -1.0F,
             !model.job.active)) {
    paint.actions.push_back(act::OpenDemo{});
  }
  if (model.library.series.empty()) {
    state.thumbnails.clear();
  } else {
    drawSeriesList(paint, model.library, state.thumbnails);
    return;
  }
  drawImport(paint, model, state);
  if (!model.library.recent.empty()) section(paint, "RECENT CASES");
  for (const RecentCase& recent : model.library.recent) {
    ImGui::PushID(recent.folder.c_str());
    const bool on = model.openCase.open && recent.folder == model.openCase.folder;
    if (row(paint, icon::kCube, recent.title, recent.detail, on, !model.job.active) && !on) {
      paint.actions.push_back(act::OpenCase{recent.folder});
    }
    ImGui::PopID();
  }
  if (model.openCase.open) {
    section(paint, "THIS CASE");
    keyValue(paint, "Source", model.openCase.source);
    keyValue(paint, "Voxels", model.openCase.geometry);
    for (const auto& text : model.openCase.repairs) {
      notice(paint, MessageModel::Kind::Information, "Repaired at import: " + text);
    }
    for (const auto& text : model.openCase.warnings) {
      notice(paint, MessageModel::Kind::Warning, text);
    }
  }
  space(paint, 4.0F);
  sentence(paint, "For training and research; not for diagnosis.");
}

void drawEmptyCase(const Painter& paint, const Model& model) {
  sentence(paint,
           "No case is open. Open one in the Library first; the demo is a real CT of a head.");
  if (model.library.demoAvailable &&
      button(paint, icon::kCube, "Open the demo case", Emphasis::Primary)) {
    paint.actions.push_back(act::OpenDemo{});
  }
  if (button(paint, icon::kFolderOpen, "Go to the Library", Emphasis::Normal)) {
    paint.actions.push_back(act::ShowTask{Task::Library});
  }
}

}  // namespace palpate::ui
