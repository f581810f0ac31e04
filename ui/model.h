#pragma once
/// What the window shows, as plain values. app/ fills it before each frame; ui/ only reads it and
/// answers with actions (ui/actions.h).

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/haptics/device.h"
#include "core/simulation/runner.h"
#include "core/simulation/snapshot.h"
#include "imaging/import.h"
#include "imaging/segmentation.h"

namespace palpate::ui {

enum class Task : std::uint8_t { Library, Segment, Simulate, Review };
inline constexpr std::size_t kTasks = 4;

/// Work that goes on in the background. Shown with a bar and Cancel.
struct JobModel {
  bool active = false;
  std::string title;      ///< "Importing the scan"
  std::string what;       ///< "Reading slice 41 of 108"
  double fraction = 0.0;  ///< [0, 1]; below 0: unknown
  bool cancellable = true;
  double seconds = 1.0;  ///< Since it began: what is soon over is not shown.
};

/// What happened, what it means for the data, what to do.
struct MessageModel {
  enum class Kind : std::uint8_t { Information, Warning, Problem } kind = Kind::Information;
  std::string happened, meaning, advice;
  double until = 1e300;  ///< Seconds of the window's clock: information goes by itself.
};

struct CaseModel {
  bool open = false;
  std::filesystem::path folder;
  std::string title, modality, geometry;  ///< "Case-7F3A", "CT", "0.96 × 0.96 × 1.50 mm"
  std::string source;                     ///< "InVesalius, 256 × 256 × 108"
  std::vector<std::string> warnings, repairs;
  bool lossy = false;
  std::vector<float> histogram;  ///< Even bins over valueRange, heights 0..1 (log).
  std::array<double, 2> valueRange{0, 0};
  /// Whose presets are offered: the modality, or, where the file does not say, what the values look
  /// like (nothing but CT reaches far below zero).
  std::string presetModality;
  /// What files made of the case are called unless the user says otherwise: never the patient.
  std::string fileName;
};

struct RecentCase {
  std::filesystem::path folder;
  std::string title, detail;
};

struct SeriesRow {
  std::string uid, title;       ///< "CT · Head"
  std::string grid, spacing;    ///< "256 × 256 × 108", "0.50 × 0.50 × 1.00 mm"
  std::string size;             ///< "82 files · 43 MB"
  std::string study;            ///< Patient and date; rows of one study are together.
  std::size_t studyNumber = 0;  ///< Two studies may be of one patient and day.
  bool importable = false;
  bool repairable = false;  ///< Not a regular box, but can be resampled to one.
  std::string reason;
  GreyPicture picture;  ///< Empty where the images cannot be decoded.
};

struct DirectoryRow {
  std::string name;
  bool folder = false;
};

struct LibraryModel {
  std::vector<RecentCase> recent;
  bool demoAvailable = false;
  std::string path;                 ///< What the path field holds.
  std::filesystem::path directory;  ///< The browser's folder.
  std::vector<DirectoryRow> entries;
  std::vector<SeriesRow> series;  ///< Not empty: several volumes, choose one.
  std::filesystem::path seriesPath;
  bool keepNames = false;  ///< The next case keeps the patient's name and identifier.
  /// A scan that was refused but can be imported resampled: what is wrong, and how ("tilt").
  std::filesystem::path repairPath;
  std::string repairUid, repairWords, repairReason;
};

struct LabelRow {
  std::string name;
  std::uint8_t value = 0;
  std::array<std::uint8_t, 3> colour{};
  std::size_t voxels = 0;
  double mm3 = 0.0;
  bool visible = true;
  std::string material = "bone";
};

/// What a label may be made of (datasets/materials.toml).
struct MaterialRow {
  std::string name;
  double stiffness_N_per_mm = 0.0, friction = 0.0, density_kg_per_m3 = 0.0;
  bool critical = false;
};

/// What a label is usually called (datasets/labels.toml).
struct AnatomyRow {
  std::string name, title;
  std::array<std::uint8_t, 3> colour{};
  std::string material;
};

/// A file that labels are to be written to.
struct ExportWish {
  std::filesystem::path file;
  std::vector<std::string> labels;  ///< Names; empty: all.
  bool overwrite = false;
};

/// Labels to and from files of other programs.
struct ExchangeModel {
  std::filesystem::path folder;  ///< Where the last file was, at first the home.
  std::vector<DirectoryRow> entries;
  std::optional<ExportWish> asks;  ///< A file of that name is there: replace it?
};

struct SegmentModel {
  std::vector<LabelRow> labels;
  std::vector<MaterialRow> materials;
  std::vector<AnatomyRow> anatomies;
  std::string undo, redo;     ///< What they would do; empty: nothing.
  bool previewing = false;    ///< A preview is being made.
  bool previewShown = false;  ///< The views show how it would be.
  std::string previewText;    ///< "bone: 432,952 voxels (-1,203)", or why there is none.
  bool previewRefused = false;
  ExchangeModel exchange;
};

struct InstrumentRow {
  std::string name, title, description;
  double length_mm = 0, width_mm = 0, mass_g = 0;
  std::vector<std::array<float, 2>> outline;  ///< Half-profile: along the shaft, radius; mm.
};

enum class HandKind : std::uint8_t { Mouse, Demo };

/// A setting, what it errs and what it costs here; as promised for motions not measured.
struct TradeRowModel {
  std::string name;
  double depth_mm = 0, force_N = 0, p99_us = 0, p999_us = 0;
  bool onFront = false;
};

struct TradeModel {
  std::vector<TradeRowModel> rows;  ///< The fastest first; empty: not measured.
  std::size_t chosen = 0;
  double limit_us = 500.0;  ///< What a step may take.
};

struct SimulateModel {
  std::vector<InstrumentRow> instruments;
  std::size_t instrument = 0;
  std::vector<std::string> devices;  ///< Simulated models.
  std::size_t device = 0;
  HandKind hand = HandKind::Mouse;
  bool hardware = false;  ///< The chosen device is real: the hand is the user's own.
  bool latch = false;     ///< Arm stays on until pressed again. Simulated devices only.
  bool ready = false;     ///< The scene is prepared.
  std::string notReady;   ///< Why not: a sentence.
  bool running = false, armed = false, recording = false;
  bool grabbed = false;  ///< The mouse holds the instrument.
  double recordedSeconds = 0;
  DeviceInfo info;            ///< Of the chosen device.
  DeviceCondition condition;  ///< What it says of itself while the simulation runs.
  bool reconnecting = false;
  int couplingPercent = 100;  ///< Of the recommended stiffness, as the user wants it.
  int loose = 0;              ///< Loose bodies of the scene.
  std::string tree, shell;    ///< "4 levels, 123 456 surface voxels", "1 204 points, 0.5 mm"
  std::vector<PlanRow> plan;  ///< What is modelled, what is not, and what it costs.
  SimulationSetting setting;
  TradeModel trade;
  bool realTime = false;
  std::string realTimeNote;
};

struct SessionRow {
  std::filesystem::path file;
  std::string title, detail;
  bool exact = true, finished = true;
};

struct ReviewModel {
  std::vector<SessionRow> sessions;
  std::optional<std::size_t> chosen;
  std::vector<float> time_s, force_N, depth_mm;
  double duration_s = 0, at_s = 0;
  bool playing = false;
  enum class Verdict : std::uint8_t { None, Identical, Different } verdict = Verdict::None;
  std::string verdictText;
};

enum class DeviceHealth : std::uint8_t { Good, Late, Fault };

struct Model {
  Task task = Task::Library;
  CaseModel openCase;
  LibraryModel library;
  SegmentModel segment;
  /// Ranges of the presets that fit the open case's modality, in their order.
  std::vector<ThresholdRange> presetRanges;
  SimulateModel simulate;
  ReviewModel review;
  JobModel job;
  std::vector<MessageModel> messages;
  /// What the simulation (or a replay) shows; null: nothing runs.
  const Snapshot* snapshot = nullptr;
  std::vector<float> forceTrace;  ///< Newest last, N; for the strip.
  bool hideTimes = false;         ///< Wall times show as dashes (pictures must not differ).
  DeviceHealth health = DeviceHealth::Good;
  std::string healthSentence;
  bool askClose = false;  ///< A recording would be lost: ask.
};

}  // namespace palpate::ui
