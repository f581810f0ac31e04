#pragma once
/// The four task panels and their larger parts, and what lies over everything. Each reads the model
/// and pushes actions; what a panel remembers between frames (text being typed, sliders) is its own
/// state struct.

#include <map>
#include <string>

#include "imaging/exchange/exchange_format.h"
#include "ui/gl_objects.h"
#include "ui/model.h"
#include "ui/segment_state.h"
#include "ui/view_state.h"
#include "ui/widgets.h"

namespace palpate::ui {

/// Of the series listed, by UID.
using Thumbnails = std::map<std::string, GlTexture>;

struct LibraryPanelState {
  Thumbnails thumbnails;
  std::string path;
  bool browsing = false;
};
void drawLibraryPanel(const Painter& paint, const Model& model, LibraryPanelState& state);
/// The part of the Library panel where a study has several series.
void drawSeriesList(const Painter& paint, const LibraryModel& library, Thumbnails& thumbnails);
/// The dialogs of labels to and from files.
struct ExchangePanelState {
  enum class Dialog : std::uint8_t { None, Export, Join } wanted = Dialog::None;  ///< Opens next.
  ExchangeFormat format = ExchangeFormat::DicomSeg;
  std::string label;   ///< To export; empty: all.
  std::string path;    ///< To write.
  bool named = false;  ///< The user chose the path: it follows the format by its ending alone.
  std::string from;    ///< To read.
  std::string only;    ///< Name in the file.
  bool browsing = false, asked = false;
  std::filesystem::path shownFolder;
};
/// `chosen`: the label that the tools work on.
void drawExchange(const Painter& paint, const Rect& window, const Model& model,
                  ExchangePanelState& state, const std::string& chosen);

/// Labels, tools, the chosen tool's settings. `now`: seconds, monotonic.
void drawSegmentPanel(const Painter& paint, const Model& model, SegmentPanelState& state,
                      ExchangePanelState& exchange, ViewState& views, double now);
/// An arrow beside a name field that offers the usual anatomy; the one chosen, or null.
const AnatomyRow* chooseAnatomy(const Painter& paint, const SegmentModel& segment);
/// The part of the Segment panel that lists and edits the labels.
void drawLabelTable(const Painter& paint, const SegmentModel& segment, SegmentPanelState& state,
                    ExchangePanelState& exchange);
/// The part of the Segment panel with the chosen tool's settings.
void drawToolSettings(const Painter& paint, const Model& model, SegmentPanelState& state);
void drawSimulatePanel(const Painter& paint, const Model& model, bool& spaceHolds);
/// The part of the Simulate panel that chooses the device and says how it is.
void drawDevice(const Painter& paint, const SimulateModel& simulate);
/// The part of the Simulate panel where speed is traded for accuracy.
void drawTrade(const Painter& paint, const SimulateModel& simulate, const Snapshot* snapshot,
               bool busy);
void drawReviewPanel(const Painter& paint, const Model& model);

/// "What to do next", where there is no case.
void drawEmptyCase(const Painter& paint, const Model& model);

/// The job's card, messages and questions over the views; the list of shortcuts when `help`.
void drawJob(const Painter& paint, const Rect& area, const JobModel& job);
void drawMessages(const Painter& paint, const Rect& area,
                  const std::vector<MessageModel>& messages);
void drawShortcuts(const Painter& paint, const Rect& window, bool& help);
void drawCloseQuestion(const Painter& paint, const Rect& window);

}  // namespace palpate::ui
