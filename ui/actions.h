#pragma once
/// What the user asked for in a frame. app/ carries it out.

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "imaging/segment/tools.h"
#include "ui/model.h"

namespace palpate::ui::act {

struct ShowTask {
  Task task;
};
struct OpenCase {
  std::filesystem::path folder;
};
struct OpenDemo {};
struct ForgetRecent {
  std::filesystem::path folder;
};
struct Browse {
  std::filesystem::path folder;
};
/// Lists the series and imports the only one, or shows them to choose from.
struct Import {
  std::filesystem::path path;
};
struct ImportSeries {
  std::filesystem::path path;
  std::string uid;
};
struct CloseSeriesList {};
/// Whether the next case keeps the patient's name and identifier.
struct KeepNames {
  bool yes;
};
/// Leave to resample, for the scan that is offered (LibraryModel::repairPath).
struct ImportRepaired {
  bool yes;
};
/// Sweeps the settings and shows what the scene's own costs and errs.
/// Speed against accuracy, for the scene as it is.
struct MeasureTrade {};
/// One of TradeModel::rows.
struct ChooseTrade {
  std::string name;
};
struct CancelJob {};
struct DismissMessage {
  std::size_t index;
};

/// Shows how the step would leave the labels; nothing changes.
struct PreviewStep {
  LabelStep step;
};
struct DropPreview {};
struct ApplyStep {
  LabelStep step;
};
/// Name, colour, material of a label.
struct EditLabel {
  std::uint8_t value;
  std::string name;
  std::array<std::uint8_t, 3> colour;
  std::string material;
};
/// Labels to a file of another program. A file that is there is kept and asked about, unless the
/// wish says otherwise.
struct ExportLabels {
  ExportWish wish;
};
/// The file that is there stays (ExchangeModel::asks).
struct KeepFile {};
/// The labels of a file into the case; `only`: the new name of its one label, or which of several.
struct JoinLabels {
  std::filesystem::path file;
  std::string only;
};
/// Lists a folder for the two above; empty: where the last file was.
struct BrowseLabels {
  std::filesystem::path folder;
};
struct ShowLabel {
  std::uint8_t value;
  bool visible;
};
struct Undo {};
struct Redo {};
/// From the labels to touching them.
struct TouchIt {};

struct ChooseInstrument {
  std::size_t index;
};
struct ChooseDevice {
  std::size_t index;
};
struct ChooseHand {
  HandKind hand;
};
struct Latch {
  bool on;
};
struct StartStop {};
struct Record {};
struct ResetTool {};
struct ForceOff {};
struct ClearFault {};
struct Arm {
  bool on;
};  ///< Hold-to-enable: sent when it changes.
struct Grab {
  bool on;
};  ///< The mouse takes or lets go of the instrument.
/// World motion of the simulated hand, metres.
struct MoveHand {
  Eigen::Vector3d delta_W;
};
struct TurnHand {
  Eigen::Vector3d rotation_W;
};  ///< Rotation vector, rad.
struct SolverIterations {
  std::uint32_t count;
};

/// Of the coupling's recommended stiffness.
struct Coupling {
  int percent;
};
struct ConfirmCalibration {};
struct Reconnect {};

struct RefreshSessions {};
struct ChooseSession {
  std::size_t index;
};
struct Replay {};
struct PlayPause {};
struct Scrub {
  double at_s;
};

struct SwitchTheme {};
struct CloseAnyway {};
struct StayOpen {};

}  // namespace palpate::ui::act

namespace palpate::ui {

using Action =
    std::variant<act::ShowTask, act::OpenCase, act::OpenDemo, act::ForgetRecent, act::Browse,
                 act::Import, act::ImportSeries, act::CloseSeriesList, act::KeepNames,
                 act::ImportRepaired, act::MeasureTrade, act::ChooseTrade, act::CancelJob,
                 act::DismissMessage, act::PreviewStep, act::DropPreview, act::ApplyStep,
                 act::EditLabel, act::ShowLabel, act::ExportLabels, act::KeepFile, act::JoinLabels,
                 act::BrowseLabels, act::Undo, act::Redo, act::TouchIt, act::ChooseInstrument,
                 act::ChooseDevice, act::ChooseHand, act::Latch, act::StartStop, act::Record,
                 act::ResetTool, act::ForceOff, act::ClearFault, act::Arm, act::Grab, act::MoveHand,
                 act::TurnHand, act::SolverIterations, act::Coupling, act::ConfirmCalibration,
                 act::Reconnect, act::RefreshSessions, act::ChooseSession, act::Replay,
                 act::PlayPause, act::Scrub, act::SwitchTheme, act::CloseAnyway, act::StayOpen>;
using Actions = std::vector<Action>;

}  // namespace palpate::ui
