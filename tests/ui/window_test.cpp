/// The window drawn whole, against a picture that was looked at. Needs a display (Xvfb in CI).

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

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
    model.openCase.title = "Synthetic head";
    model.openCase.modality = "CT";
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
    model.simulate.accuracy =
        "\xc2\xb1"
        "0.12 mm \xc2\xb1"
        "0.05 N";
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
  workspace.showVolume(shown.head);
  workspace.showLabels(&shown.bone);
  const auto chunks = meshLabel(shown.bone, 1, 1);
  ASSERT_TRUE(chunks) << sentence(chunks.error());
  workspace.showSurface(1, *chunks);
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

}  // namespace
}  // namespace palpate::ui
