/// The window drawn whole, against a picture that was looked at. Needs a display (Xvfb in CI).

#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>

#include "imaging/surface.h"
#include "tests/ui/synthetic_case.h"
#include "ui/workspace.h"

namespace palpate::ui {
namespace {

std::filesystem::path shaders() {
  return std::filesystem::path(PALPATE_SHADERS);
}

/// A model as app/ would fill it, with numbers that never change.
struct Shown {
  Volume head = test::syntheticHead(96);
  LabelGrid bone = test::syntheticBone(head);
  Snapshot snapshot = test::syntheticContact(head);
  Model model;

  Shown() {
    model.task = Task::Simulate;
    model.openCase.open = true;
    model.openCase.folder = "case";
    model.openCase.title = "Synthetic head";
    model.openCase.modality = model.openCase.presetModality = "CT";
    model.openCase.geometry = "2.08 \xc3\x97 2.08 \xc3\x97 2.08 mm";
    model.openCase.source = "MetaImage, 96 \xc3\x97 108 \xc3\x97 96";
    model.openCase.valueRange = {-1000, 1150};
    for (int i = 0; i < 128; ++i) {
      model.openCase.histogram.push_back(i < 5 || (i > 58 && i < 66) ? 0.9F
                                                                     : 0.02F * float(i % 13));
    }
    model.segment.labels.push_back({"bone", 1, {227, 211, 177}, 84123, 761240.0, true});
    model.simulate.instruments.push_back(
        {"ball-burr", "Ball burr, 6 mm", "Round burr", 122, 6, 38, outline()});
    model.simulate.devices = {"touch", "touch-x", "premium-6dof"};
    model.simulate.device = 1;
    model.simulate.ready = model.simulate.running = model.simulate.armed = true;
    model.simulate.latch = true;
    model.simulate.info.name = "Simulated Touch X";
    model.simulate.info.couplingStiffness = 600;
    model.simulate.tree = "4 levels, 84 123 voxels";
    model.simulate.shell = "2 048 points, 0.50 mm";
    model.simulate.trade.rows = {{"shell=2.00mm", 0.42, 0.41, 6.0, 18, true},
                                 {"iterations=20", 0.12, 0.22, 8.0, 19, true},
                                 {"leaf=voxel", 0.30, 0.55, 12.0, 40, false},
                                 {"default", 0.12, 0.20, 14.0, 30, false},
                                 {"shell=0.25mm", 0.02, 0.13, 21.0, 60, true}};
    model.simulate.trade.chosen = 1;
    model.forceTrace = {0,    0,    0.2F,  0.6F, 0.9F,  1.4F, 1.3F,
                        1.1F, 1.2F, 1.25F, 1.3F, 1.24F, 1.2F, 1.24F};
    model.snapshot = &snapshot;
  }
  static std::vector<std::array<float, 2>> outline() {
    return {{0, 0},     {1, 2.2F}, {3, 3},     {5, 2.2F}, {7, 1.1F},
            {45, 1.1F}, {48, 4},   {60, 5.5F}, {122, 6}};
  }
};

void fill(Workspace& workspace, const Shown& shown) {
  workspace.showVolume(std::make_shared<const Volume>(shown.head), lookOf(shown.head));
  workspace.showLabels(std::make_shared<const LabelGrid>(shown.bone));
  auto chunks = meshLabel(shown.bone, 1, 1);
  ASSERT_TRUE(chunks) << sentence(chunks.error());
  workspace.showSurface(1, std::make_shared<const std::vector<SurfaceChunk>>(std::move(*chunks)));
  workspace.showRows(shown.model.segment.labels);
  workspace.showInstrument(test::syntheticBurr());
}

class WindowTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("DISPLAY") == nullptr) {
      GTEST_SKIP() << "There is no display; run under xvfb-run -a.";
    }
  }
  /// Opens, draws `frames` frames, returns the picture.
  Picture drawn(Shown& shown, const WindowOptions& options, int frames = 4,
                const std::function<void(Workspace&)>& prepare = {}) {
    auto window = Window::open(options);
    EXPECT_TRUE(window) << sentence(window.error());
    auto workspace = Workspace::load(shaders());
    EXPECT_TRUE(workspace) << sentence(workspace.error());
    if (!window || !workspace) return {};
    for (int f = 0; f < frames; ++f) {
      (*window)->beginFrame(0.0);
      ImGui::GetIO().DeltaTime = 1.0F / 60.0F;
      if (f == 1) fill(**workspace, shown);
      if (f == 1 && prepare) prepare(**workspace);
      (void)(*workspace)->draw(**window, shown.model, f / 60.0, false);
      (*window)->endFrame();
    }
    return (*window)->picture();
  }
  static WindowOptions options(bool light = false) {
    WindowOptions o;
    o.scale = 1.0F;
    o.visible = false;
    o.light = light;
    return o;
  }
  static void expectGolden(const Picture& actual, const std::string& name) {
    const std::filesystem::path golden =
        std::filesystem::path(PALPATE_TEST_FILES) / "ui/golden" / (name + ".png");
    ASSERT_TRUE(writePng(actual, name + "_actual.png"));
    if (std::getenv("PALPATE_ACCEPT_GOLDENS") != nullptr) {
      ASSERT_TRUE(writePng(actual, golden));
      return;
    }
    const auto expected = readPng(golden);
    ASSERT_TRUE(expected) << sentence(expected.error());
    const PictureDifference difference = compare(actual, *expected);
    if (difference.image.width > 0) {
      ASSERT_TRUE(writePng(difference.image, name + "_difference.png"));
    }
    EXPECT_LE(difference.share, 0.001)
        << difference.pixelsBeyond << " pixels differ; see " << name << "_actual.png and " << name
        << "_difference.png in " << std::filesystem::current_path();
  }
};

TEST_F(WindowTest, LooksAsAccepted) {
  Shown shown;
  expectGolden(drawn(shown, options()), "window_simulate_dark");
}

TEST_F(WindowTest, LooksAsAcceptedInLight) {
  Shown shown;
  shown.model.task = Task::Segment;
  expectGolden(drawn(shown, options(true)), "window_segment_light");
}

using Clock = std::chrono::steady_clock;

/// A large scan takes longer than a frame to send: it goes slice by slice, as far as there is time.
TEST_F(WindowTest, TexturesAreSentSliceBySliceAndOnlyWhereLabelsDiffer) {
  const auto window = Window::open(options());
  ASSERT_TRUE(window) << sentence(window.error());
  const auto head = std::make_shared<const Volume>(test::syntheticHead(24));
  const auto bone = std::make_shared<const LabelGrid>(test::syntheticBone(*head));
  VolumeTextures textures;
  textures.setVolume(head, brickMaxima(*head, VolumeTextures::kBrick));
  for (int slice = 0; slice < 24; ++slice) {
    EXPECT_FALSE(textures.loaded()) << slice;
    textures.send(Clock::now());
  }
  EXPECT_TRUE(textures.loaded());
  EXPECT_FALSE(textures.sending());

  textures.setLabels(bone);
  textures.send(Clock::now());
  EXPECT_FALSE(textures.hasLabels()) << "one slice of 24 is there";
  textures.send(Clock::time_point::max());
  EXPECT_TRUE(textures.hasLabels());
  EXPECT_EQ(textures.labelSlicesSent(), 24U);

  const auto stroke = std::make_shared<LabelGrid>(*bone);
  stroke->labels[bone->geometry.index(3, 4, 7)] ^= 2;
  textures.setLabels(stroke);
  const std::uint64_t before = textures.version();
  textures.send(Clock::time_point::max());
  EXPECT_EQ(textures.labelSlicesSent(), 25U);
  EXPECT_GT(textures.version(), before);

  // Taken back on the way: the slices that were sent are sent again, and the one of the stroke.
  const auto other = std::make_shared<LabelGrid>(*stroke);
  for (std::uint8_t& label : other->labels) label ^= 4;
  textures.setLabels(other);
  for (int slice = 0; slice < 3; ++slice) textures.send(Clock::now());
  EXPECT_EQ(textures.labelSlicesSent(), 28U);
  textures.setLabels(bone);
  textures.send(Clock::time_point::max());
  EXPECT_EQ(textures.labelSlicesSent(), 32U);
  const std::uint64_t shown = textures.version();
  textures.setLabels(std::make_shared<const LabelGrid>(*bone));
  textures.send(Clock::time_point::max());
  EXPECT_EQ(textures.version(), shown) << "equal labels are nothing new";
}

TEST_F(WindowTest, ASurfaceIsSentChunkByChunkAndShownWhole) {
  const auto window = Window::open(options());
  ASSERT_TRUE(window) << sentence(window.error());
  Shown shown;
  auto made = meshLabel(shown.bone, 1, 1);
  ASSERT_TRUE(made) << sentence(made.error());
  const auto chunks = std::make_shared<const std::vector<SurfaceChunk>>(std::move(*made));
  ASSERT_GT(chunks->size(), 2U);
  SurfaceLayer surface;
  surface.setLabel(1, chunks, Eigen::Vector3d::Zero());
  EXPECT_TRUE(surface.bounds_mm());
  for (std::size_t chunk = 0; chunk < chunks->size(); ++chunk) {
    EXPECT_EQ(surface.triangles(), 0U);
    surface.send(Clock::now());
  }
  EXPECT_FALSE(surface.sending());
  const std::size_t triangles = surface.triangles();
  EXPECT_GT(triangles, 0U);
  surface.setRows(shown.model.segment.labels);
  const std::uint64_t version = surface.version();
  surface.setRows(shown.model.segment.labels);
  surface.setLoose({});
  EXPECT_EQ(surface.version(), version) << "nothing changed, so nothing is drawn again";
  // The old one is drawn until the new one is whole.
  surface.setLabel(1, chunks, Eigen::Vector3d::Zero());
  surface.send(Clock::now());
  EXPECT_EQ(surface.triangles(), triangles);
  surface.setLabel(1, std::make_shared<const std::vector<SurfaceChunk>>(), {0, 0, 0});
  surface.send(Clock::now());
  EXPECT_EQ(surface.triangles(), 0U);
  EXPECT_FALSE(surface.bounds_mm());
}

/// Draws with a script's input until it ends; gives the actions of all frames.
Actions played(Window& window, Workspace& workspace, const Model& model, const std::string& text,
               double& now) {
  Actions all;
  auto script = UiScript::parse(text, "test");
  EXPECT_TRUE(script);
  while (script && !script->finished()) {
    const auto input = script->next(workspace.items(), true);
    EXPECT_TRUE(input) << sentence(input.error());
    if (!input) break;
    window.inject(*input);
    window.beginFrame(0.0);
    ImGui::GetIO().DeltaTime = 1.0F / 60.0F;
    const Actions actions = workspace.draw(window, model, now += 1.0, true);
    all.insert(all.end(), actions.begin(), actions.end());
    window.endFrame();
  }
  return all;
}

template <class T>
int countOf(const Actions& actions) {
  int count = 0;
  for (const Action& action : actions) count += std::holds_alternative<T>(action) ? 1 : 0;
  return count;
}

class InteractionTest : public WindowTest {
 protected:
  void SetUp() override {
    WindowTest::SetUp();
    if (IsSkipped()) return;
    auto window = Window::open(options());
    ASSERT_TRUE(window) << sentence(window.error());
    window_ = std::move(*window);
    auto workspace = Workspace::load(shaders());
    ASSERT_TRUE(workspace) << sentence(workspace.error());
    workspace_ = std::move(*workspace);
    (void)play("wait 2");
    fill(*workspace_, shown_);
    (void)play("wait 2");
  }
  Actions play(const std::string& text) {
    return played(*window_, *workspace_, shown_.model, text, now_);
  }
  Shown shown_;
  std::unique_ptr<Window> window_;
  std::unique_ptr<Workspace> workspace_;
  double now_ = 0.0;  ///< The window's clock: a second a frame.
};

TEST_F(InteractionTest, PicturesAreMadeOnlyWhenTheirInputsChange) {
  (void)play("wait 60");  // the full picture of the anatomy is made in bands
  const int before = workspace_->picturesMade();
  (void)play("wait 20");
  EXPECT_EQ(workspace_->picturesMade(), before);
  EXPECT_FALSE(workspace_->busy());
  (void)play("move 600 400\nwheel 1\nwait 1");
  EXPECT_EQ(workspace_->picturesMade(), before + 1) << "the 3D view alone";
}

TEST_F(InteractionTest, DoubleClickFillsTheWindowAndEscapeReturns) {
  (void)play("double 1140 160\nwait 2");
  ASSERT_EQ(workspace_->views().filled, View::Axial);
  EXPECT_FLOAT_EQ(workspace_->layout().view[1].w, 1280.0F);
  const Actions actions = play("key escape\nwait 2");
  EXPECT_EQ(workspace_->views().filled, std::nullopt);
  EXPECT_EQ(countOf<act::ForceOff>(actions), 1) << "escape is force off before anything else";
}

TEST_F(InteractionTest, KeysAndTabsAskForTheirTask) {
  for (const auto& [input, task] :
       {std::pair{"key 2", Task::Segment}, std::pair{"click-item Review", Task::Review}}) {
    const Actions actions = play(input);
    ASSERT_EQ(countOf<act::ShowTask>(actions), 1) << input;
    for (const Action& action : actions) {
      const auto* show = std::get_if<act::ShowTask>(&action);
      EXPECT_TRUE(show == nullptr || show->task == task) << input;
    }
  }
}

TEST_F(InteractionTest, TheWheelTurnsSlicesAndTheRightButtonChangesTheWindow) {
  shown_.model.snapshot = nullptr;
  const double z = workspace_->views().crosshair_P.z();
  (void)play("move 1140 160\nwheel 3\nwait 1");
  EXPECT_NEAR(workspace_->views().crosshair_P.z() - z, 3 * shown_.head.geometry.spacing.z(),
              0.6 * shown_.head.geometry.spacing.z());
  const double width = workspace_->views().window[1];
  (void)play("drag 1100 150 1180 150 right\nwait 1");
  EXPECT_GT(workspace_->views().window[1], width * 1.1);
  (void)play("click 1100 120\nwait 1");
  EXPECT_LT(workspace_->views().crosshair_P.x(), 0.0)
      << "left of the middle is the patient's right";
}

TEST_F(InteractionTest, ASliceIsEnlargedAboutTheMouseAndByItsButton) {
  shown_.model.snapshot = nullptr;
  (void)play("click 1100 120\nwait 1");
  const Eigen::Vector3d before = workspace_->views().crosshair_P;
  // A click elsewhere between two at one place, else they are a double-click.
  (void)play("hold ctrl\nwheel 5\nlet ctrl\nwait 1\nclick 600 400\nclick 1100 120\nwait 1");
  EXPECT_GT(workspace_->views().slice[1].zoom, 1.9);
  EXPECT_LT((workspace_->views().crosshair_P - before).norm(), 1e-6);
  (void)play("click 600 400\nwait 1");
  shown_.model.task = Task::Segment;
  workspace_->segment().kind = ToolKind::Brush;
  (void)play("double 1100 120\nwait 2");
  EXPECT_EQ(workspace_->views().filled, std::nullopt) << "the brush paints";
  (void)play("click-item Fill the window with this slice\nwait 2");
  EXPECT_EQ(workspace_->views().filled, View::Axial);
}

TEST_F(InteractionTest, SidesOfTheBoxAreDraggedAndAClickChangesNothing) {
  shown_.model.snapshot = nullptr;
  shown_.model.task = Task::Segment;
  SegmentPanelState& state = workspace_->segment();
  (void)play("wait 1");
  state.kind = ToolKind::Box;
  (void)play("drag 1100 120 1180 200\nwait 1");
  ASSERT_TRUE(state.box_mm);
  const auto drawn = *state.box_mm;
  (void)play("click 1130 150\nwait 1");
  ASSERT_TRUE(state.box_mm);
  EXPECT_EQ((*state.box_mm)[0], drawn[0]);
  EXPECT_EQ((*state.box_mm)[1], drawn[1]);
  (void)play("drag 1180 160 1200 170\nwait 1");
  const auto moved = *state.box_mm;
  EXPECT_EQ(moved[0], drawn[0]);
  EXPECT_GT(moved[1].x(), drawn[1].x()) << "the patient's left is at the right";
  EXPECT_EQ(moved[1].y(), drawn[1].y());
  EXPECT_EQ(moved[1].z(), drawn[1].z());
}

/// Seeds go onto the label as it is, though the preview already shows a part of it as another.
TEST_F(InteractionTest, ASplitIsMendedByAClickOnWhatThePreviewTookAway) {
  shown_.model.snapshot = nullptr;
  shown_.model.task = Task::Segment;
  SegmentPanelState& state = workspace_->segment();
  (void)play("wait 1");
  state.kind = ToolKind::Split;
  LabelGrid preview = shown_.bone;
  for (auto& label : preview.labels) label = label == 1 ? 2 : 0;
  workspace_->showPreview(std::make_shared<const LabelGrid>(preview));
  (void)play("wait 2\nclick 620 300\nwait 2");
  EXPECT_EQ(state.picks.size(), 1U) << "the forehead, in 3D";
  EXPECT_FALSE(state.missed);
  (void)play("click 310 700\nwait 2");
  EXPECT_EQ(state.picks.size(), 1U);
  EXPECT_TRUE(state.missed) << "beside the head";
}

TEST_F(InteractionTest, WithShiftTheMouseMovesTheHandAndNotTheCamera) {
  const Camera before = workspace_->views().camera;
  const Actions actions =
      play("move 600 400\nhold shift\nmove 620 400\nmove 640 400\nlet shift\nwait 1");
  EXPECT_GE(countOf<act::MoveHand>(actions), 1);
  EXPECT_TRUE(workspace_->views().camera == before);
  (void)play("drag 600 400 660 400");
  EXPECT_FALSE(workspace_->views().camera == before) << "without it the drag orbits";
}

TEST_F(InteractionTest, ArmingLastsAsLongAsItIsHeld) {
  shown_.model.simulate.latch = false;
  shown_.model.simulate.armed = false;
  const Actions actions = play("hold a\nwait 3\nlet a\nwait 2");
  std::vector<bool> arms;
  for (const Action& action : actions) {
    if (const auto* arm = std::get_if<act::Arm>(&action)) arms.push_back(arm->on);
  }
  EXPECT_EQ(arms, (std::vector<bool>{true, false}));
}

TEST_F(InteractionTest, AReturnShorterThanAFrameImportsThePath) {
  shown_.model.task = Task::Library;
  (void)play("wait 2\nclick-item Path of the scan\nwait 1\ntext /scans/head\nwait 1");
  // As GLFW gives it when both come between two frames.
  GLFWwindow* window = glfwGetCurrentContext();
  const GLFWkeyfun stroke = glfwSetKeyCallback(window, nullptr);
  glfwSetKeyCallback(window, stroke);
  stroke(window, GLFW_KEY_ENTER, 0, GLFW_PRESS, 0);
  stroke(window, GLFW_KEY_ENTER, 0, GLFW_RELEASE, 0);
  const Actions actions = play("wait 3");
  ASSERT_EQ(countOf<act::Import>(actions), 1);
  for (const Action& action : actions) {
    if (const auto* wish = std::get_if<act::Import>(&action)) {
      EXPECT_EQ(wish->path, "/scans/head");
    }
  }
}

TEST_F(InteractionTest, ANameInAnotherScriptIsDrawnFromTheNextFrameOn) {
  shown_.model.task = Task::Library;
  SeriesRow series;
  series.uid = "1";
  series.study = "\xe5\xb1\xb1\xe7\x94\xb0";
  shown_.model.library.series = {series};
  (void)play("wait 2");
  EXPECT_NE(window_->fonts().body->FindGlyphNoFallback(0x5c71), nullptr);
  EXPECT_NE(window_->fonts().body->FindGlyphNoFallback('a'), nullptr);
}

/// Whatever is open above it, the button that applies is whole in the panel and covers nothing.
TEST_F(WindowTest, ApplyIsInReachInEveryTool) {
  struct Size {
    float scale;
    int width, height;  // before scaling
  };
  for (const Size& size : {Size{1.0F, 1280, 800}, Size{1.5F, 1280, 800}, Size{1.5F, 854, 534}}) {
    WindowOptions o = options();
    o.scale = size.scale;
    o.width = size.width;
    o.height = size.height;
    auto window = Window::open(o);
    ASSERT_TRUE(window) << sentence(window.error());
    auto workspace = Workspace::load(shaders());
    ASSERT_TRUE(workspace);
    Shown shown;
    shown.model.task = Task::Segment;
    for (std::uint8_t v = 2; v <= 8; ++v) {
      std::string name = "label " + std::to_string(v) + " " + std::string(56, 'm');
      if (v == 8) {
        name.clear();
        for (int i = 0; i < 60; ++i) name += "\xe5\xb1\xb1";
      }
      shown.model.segment.labels.push_back({name, v, {90, 120, 200}, 84123, 761240.0, true});
    }
    shown.model.segment.previewText =
        "Preview: 143,295,232 voxels, 12,432,952 fewer and more words than the line can hold";
    double now = 0.0;
    (void)played(**window, **workspace, shown.model, "wait 2", now);
    fill(**workspace, shown);
    for (std::size_t kind = 0; kind < kTools; ++kind) {
      SegmentPanelState& state = (*workspace)->segment();
      state.kind = static_cast<ToolKind>(kind);
      state.editing = 8;
      shown.model.segment.previewRefused = kind % 2 == 1;
      (void)played(**window, **workspace, shown.model, "wait 3", now);
      const bool draws = state.kind == ToolKind::Brush || state.kind == ToolKind::Eraser ||
                         state.kind == ToolKind::Scissors;
      std::vector<std::string> names{"Undo", "Redo", "Touch it"};
      if (!draws) {
        names.push_back(kind == 0 ? std::string("Segment tissue")
                                  : std::string("Apply ") + toolWords(state.kind).title);
      }
      const Rect& panel = (*workspace)->layout().panel;
      for (std::size_t i = 0; i < names.size(); ++i) {
        SCOPED_TRACE(names[i] + " at " + std::to_string(size.scale));
        const auto at = (*workspace)->items().find(names[i]);
        ASSERT_NE(at, (*workspace)->items().end());
        const Rect& r = at->second;
        EXPECT_GE(r.x, panel.x);
        EXPECT_LE(r.right(), panel.right());
        EXPECT_GE(r.y, panel.y);
        EXPECT_LE(r.bottom(), panel.bottom());
        for (std::size_t j = 0; j < i; ++j) {
          EXPECT_FALSE(r.overlaps((*workspace)->items().at(names[j]))) << names[j];
        }
      }
    }
  }
}

std::vector<ExportWish> exportsOf(const Actions& actions) {
  std::vector<ExportWish> wishes;
  for (const Action& action : actions) {
    if (const auto* wish = std::get_if<act::ExportLabels>(&action)) wishes.push_back(wish->wish);
  }
  return wishes;
}

constexpr const char* kOpenExport = "wait 2\nclick-item Export\xe2\x80\xa6\nwait 3\n";

TEST_F(InteractionTest, AnExportIsNamedByThePseudonymAndItsFormat) {
  shown_.model.task = Task::Segment;
  shown_.model.openCase.fileName = "Case-7F3A";
  shown_.model.segment.exchange.folder = "/out";
  shown_.model.segment.labels.push_back({"a/b", 2, {90, 120, 200}, 8, 8.0, true});
  const auto wishes = exportsOf(
      play(std::string(kOpenExport) + "click-item Export\nwait 3\n" + kOpenExport +
           "click-item STL\nwait 2\nclick-item Export\nwait 3\n" + kOpenExport +
           "click-item What to export\nwait 3\nclick-item Only bone\nwait 3\nclick-item Export\n" +
           "wait 3\n" + kOpenExport + "click-item NRRD\nwait 2\nclick-item Export\nwait 3"));
  ASSERT_EQ(wishes.size(), 4U);
  EXPECT_EQ(wishes[0].file, "/out/Case-7F3A-labels.dcm");
  EXPECT_TRUE(wishes[0].labels.empty());
  EXPECT_EQ(wishes[1].file, "/out/Case-7F3A-a-b.stl") << "the label that is worked on";
  EXPECT_EQ(wishes[1].labels, std::vector<std::string>{"a/b"});
  EXPECT_EQ(wishes[2].file, "/out/Case-7F3A-bone.stl");
  EXPECT_EQ(wishes[3].file, "/out/Case-7F3A-labels.seg.nrrd");
  EXPECT_TRUE(wishes[3].labels.empty());
}

TEST_F(InteractionTest, AnEndingThatIsTypedChoosesTheFormat) {
  shown_.model.task = Task::Segment;
  const auto wishes =
      exportsOf(play(std::string(kOpenExport) +
                     "click-item Path of the file\nwait 1\nhold ctrl\nkey a\nlet ctrl\nwait 1\n"
                     "text /out/mine.ply\nwait 2\nclick-item Export\nwait 3\n" +
                     kOpenExport + "click-item NRRD\nwait 2\nclick-item Export\nwait 3"));
  ASSERT_EQ(wishes.size(), 2U);
  EXPECT_EQ(wishes[0].file, "/out/mine.ply");
  EXPECT_EQ(wishes[0].labels, std::vector<std::string>{"bone"});
  EXPECT_EQ(wishes[1].file, "/out/mine.seg.nrrd") << "a name that was chosen stays";
  EXPECT_TRUE(wishes[1].labels.empty());
}

TEST_F(InteractionTest, AFileThatIsThereIsAskedAbout) {
  shown_.model.task = Task::Segment;
  auto& asks = shown_.model.segment.exchange.asks;
  asks = ExportWish{"/out/there.dcm", {}, true};
  Actions actions = play("wait 3\nclick-item Replace it\nwait 1");
  ASSERT_EQ(exportsOf(actions).size(), 1U);
  EXPECT_TRUE(exportsOf(actions)[0].overwrite);
  asks.reset();
  (void)play("wait 3");
  asks = ExportWish{"/out/there.dcm", {}, true};
  actions = play("wait 3\nkey escape\nwait 1");
  EXPECT_TRUE(exportsOf(actions).empty());
  EXPECT_GE(countOf<act::KeepFile>(actions), 1) << "escape keeps the file";
  EXPECT_EQ(countOf<act::ForceOff>(actions), 1);
}

TEST_F(InteractionTest, KeysWaitWhileADialogIsOpen) {
  shown_.model.task = Task::Segment;
  const Actions actions = play(std::string(kOpenExport) + "key space\nkey 3\nkey r\nwait 2");
  EXPECT_EQ(countOf<act::StartStop>(actions) + countOf<act::ShowTask>(actions) +
                countOf<act::Record>(actions),
            0);
}

TEST_F(InteractionTest, TheVolumeRenderingShowsBoneInFrontOfTheBackdrop) {
  (void)play("key v\nwait 2");
  Picture picture;
  for (int i = 0; i < 400 && (i < 3 || workspace_->busy()); ++i) (void)play("wait 1");
  EXPECT_FALSE(workspace_->busy());
  picture = window_->picture();
  // The middle of the forehead against a corner of the view: bone is light, the ground dark.
  const auto brightness = [&picture](int x, int y) {
    const auto at = static_cast<std::size_t>((y * picture.width + x) * 4);
    return picture.rgba[at] + picture.rgba[at + 1] + picture.rgba[at + 2];
  };
  EXPECT_GT(brightness(620, 300), 250);
  EXPECT_LT(brightness(330, 690), 150);
}

}  // namespace
}  // namespace palpate::ui
