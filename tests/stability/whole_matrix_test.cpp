/// The matrix of haptics_facts.md §4, row by row, on analytic shapes. Every row must pass where the
/// program promises it; elsewhere (couplings that it does not offer, arms that do not exist) the
/// guards must hold. Written as tables and maps: matrix_report.h.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "tests/stability/closed_loop.h"
#include "tests/stability/matrix_report.h"
#include "tests/stability/test_hands.h"

namespace palpate::stability {
namespace {

template <class T>
std::vector<T> some(const std::vector<T>& whole, const std::vector<T>& part) {
  return kWhole ? whole : part;
}

/// The Touch' encoders of 55 µm times K and B make more ripple than others (matrix_test.cpp).
double ripple(const std::string& model) {
  return model == "touch" ? 0.15 : 0.08;
}

/// The tool may enter by what one step travels at the hand's speed.
double depthFor(const LoopCase& c) {
  return std::max(1e-4, 0.15 * c.arm.period * c.stepTicks);
}

Row runRow(const LoopCase& c, const std::string& words, double x, double y, bool promised) {
  const LoopResult r = runLoop(c);
  Row row{words + ", seed " + std::to_string(c.seed), x, y,
          judge(r.samples, r.limits, r.deepest, {ripple(c.model), depthFor(c)})};
  const Judged& j = row.judged;
  if (promised) {
    EXPECT_EQ(j.verdict, Verdict::Pass) << row.name << ": " << j.why;
  } else {
    EXPECT_LE(j.verdict, Verdict::Guarded) << row.name << ": " << j.why;
  }
  return row;
}

/// The hand lets go in the slide where there is none.
LoopCase held(const std::string& grip) {
  LoopCase c;
  c.grip = grip;
  if (grip != "none") return c;
  c.grip = "up-down";
  c.hand = std::make_shared<LettingGo>(makeSearchingHand(c.seed), 1.6);
  c.seconds = 3.0;
  return c;
}

std::string words(const char* format, auto... values) {
  char text[160];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

TEST(WholeMatrix, StiffnessByDelay) {
  // What the program offers is up to the recommended stiffness; one more tick of delay is promised
  // with it, two or three (haptics_facts.md §3) are looked at.
  std::vector<Row> rows;
  for (const std::string& model : some<std::string>(simulatedModels(), {"touch-x"})) {
    for (const std::string& grip : some<std::string>(simulatedGrips(), {"up-down", "light"})) {
      for (const double K : some<double>({50, 100, 200, 400, 600, 800, 1200, 2000, 3500, 5000},
                                         {100, 600, 2000, 5000})) {
        for (const std::uint32_t delay : some<std::uint32_t>({0, 1, 2, 3, 5}, {0, 1, 5})) {
          LoopCase c = held(grip);
          c.model = model;
          c.stiffness = K;
          c.arm.extraDelay = delay;
          const double most = model == "touch" ? 400.0 : 600.0;
          rows.push_back(runRow(c,
                                words("%s %s K %g delay %u", model.c_str(), grip.c_str(), K, delay),
                                K, delay, K <= most && delay <= 1));
        }
      }
    }
  }
  const MapAxes axes{"Coupling stiffness and delay: three arms, eight hands", "K (N/m)",
                     "extra delay (ms)"};
  report("stiffness-delay", rows, &axes);
}

TEST(WholeMatrix, StiffnessByDamping) {
  std::vector<Row> rows;
  for (const std::string& grip :
       some<std::string>({"up-down", "stiff", "light", "none"}, {"soft"})) {
    for (const double K :
         some<double>({50, 100, 200, 400, 600, 800, 1200, 2000, 5000}, {100, 600, 5000})) {
      for (const double B : some<double>({0, 0.5, 1, 2, 3, 5}, {0, 2, 5})) {
        LoopCase c = held(grip);
        c.stiffness = K;
        c.damping = B;
        rows.push_back(runRow(c, words("touch-x %s K %g B %g", grip.c_str(), K, B), K, B,
                              K <= 600.0 && B == 2.0));
      }
    }
  }
  const MapAxes axes{"Coupling stiffness and damping, Touch X", "K (N/m)", "B (N·s/m)"};
  report("stiffness-damping", rows, &axes);
}

TEST(WholeMatrix, MassByStep) {
  struct Timing {
    double period;
    std::uint32_t ticks;
  };
  std::vector<Row> rows;
  for (const double mass :
       some<double>({1e-4, 1e-3, 0.01, 0.05, 0.1, 0.5, 2, 10}, {1e-4, 0.05, 10})) {
    for (const Timing t :
         some<Timing>({{2e-4, 1}, {5e-4, 1}, {1e-3, 1}, {1e-3, 2}, {1e-3, 5}, {1e-3, 10}},
                      {{2e-4, 1}, {1e-3, 1}, {1e-3, 10}})) {
      LoopCase c;
      c.mass = mass;
      c.arm.period = t.period;
      c.stepTicks = t.ticks;
      const double step = 1e3 * t.period * t.ticks;
      rows.push_back(runRow(c, words("tool of %g kg, step %g ms", mass, step), mass, step, true));
    }
  }
  const MapAxes axes{"Mass of the tool and length of a step, Touch X", "mass (kg)", "step (ms)"};
  report("mass-step", rows, &axes);
}

TEST(WholeMatrix, ArmsHandsDelaysAndSteps) {
  std::vector<Row> rows;
  for (const std::string& model : simulatedModels()) {
    for (const std::string& grip : simulatedGrips()) {
      for (const std::uint32_t step : some<std::uint32_t>({1, 2, 5, 10}, {1, 10})) {
        for (const std::uint64_t seed : some<std::uint64_t>({1, 2, 3}, {4})) {
          LoopCase c = held(grip);
          c.model = model;
          c.stepTicks = step;
          c.seed = seed;
          if (grip != "none") c.hand = makeSearchingHand(seed);
          rows.push_back(runRow(c, words("%s %s step %u ms", model.c_str(), grip.c_str(), step),
                                step, static_cast<double>(seed), true));
        }
      }
    }
  }
  report("arms-hands-steps", rows);
}

TEST(WholeMatrix, WedgesAndHoles) {
  const double degree = std::numbers::pi / 180.0;
  std::vector<Row> rows;
  for (const double mu : some<double>({0, 0.2, 1}, {0.2})) {
    for (const std::uint32_t step : some<std::uint32_t>({1, 5, 10}, {1})) {
      for (const double angle : some<double>({0.5, 1, 2, 5, 20, 45}, {0.5, 5})) {
        LoopCase c;
        c.shape = wedge(angle * degree, 0.0027 / std::sin(angle * degree));
        c.toolFriction = mu;
        c.stepTicks = step;
        rows.push_back(
            runRow(c, words("wedge of %g degrees, friction %g, step %u ms", angle, mu, step), angle,
                   mu, true));
      }
      // The tool's ball of 3 mm radius in a hole with so much room about it.
      for (const double room : some<double>({0.1, 0.3, 0.5, 1}, {0.3})) {
        LoopCase c;
        c.shape = hole(0.003 + room * 1e-3);
        c.hand = std::make_shared<PressingHand>(0.03, -0.02);
        c.toolFriction = mu;
        c.stepTicks = step;
        rows.push_back(
            runRow(c, words("hole with %g mm of room, friction %g, step %u ms", room, mu, step),
                   room, mu, true));
      }
    }
  }
  report("wedges-holes", rows);
}

TEST(WholeMatrix, WhatReachesTheComputerIsPoor) {
  std::vector<Row> rows;
  for (const std::string& grip : some<std::string>(simulatedGrips(), {"up-down", "stiff"})) {
    const auto row = [&](const std::string& what, double x, bool promised, auto change) {
      LoopCase c = held(grip);
      change(c.arm);
      rows.push_back(runRow(c, grip + " " + what, x, 0.0, promised));
    };
    for (const double share : some<double>({0.01, 0.05, 0.2}, {0.2})) {
      row(words("%g %% of samples lost", 100 * share), share, true,
          [&](SimulatedPhantomOptions& arm) { arm.dropouts = share; });
    }
    for (const double jitter : some<double>({5e-5, 2e-4, 5e-4}, {5e-4})) {
      row(words("jitter of %g us", 1e6 * jitter), jitter, true,
          [&](SimulatedPhantomOptions& arm) { arm.jitter = jitter; });
    }
    for (const double lag : some<double>({1e-3, 2e-3}, {1e-3})) {
      row(words("amplifier lag of %g ms", 1e3 * lag), lag, true,
          [&](SimulatedPhantomOptions& arm) { arm.amplifierLag = lag; });
    }
    // Coarser than any Phantom's: looked at, not promised.
    for (const double step : some<double>({1e-5, 2.3e-5, 5.5e-5, 1e-4, 2e-4}, {1e-5, 2e-4})) {
      row(words("encoder step of %g um", 1e6 * step), step, step <= 3e-5,
          [&](SimulatedPhantomOptions& arm) { arm.encoderStep = step; });
    }
  }
  report("poor-readings", rows);
}

TEST(WholeMatrix, DemandsBeyondTheDevice) {
  // A hand that presses far deeper than the force can hold: the force keeps its direction and comes
  // back as soon as the hand does.
  std::vector<Row> rows;
  for (const std::string& model : simulatedModels()) {
    for (const double depth : some<double>({0.02, 0.04, 0.08}, {0.04})) {
      LoopCase c;
      c.model = model;
      c.grip = "stiff";
      c.hand = std::make_shared<PressingHand>(0.03, -depth);
      const LoopResult r = runLoop(c);
      Row row{model + words(" pressed to %g mm", 1e3 * depth), depth, 0.0,
              judge(r.samples, r.limits, r.deepest, {ripple(model), 1e-3})};
      EXPECT_EQ(row.judged.verdict, Verdict::Pass) << row.name << ": " << row.judged.why;
      const Eigen::Vector3d up = r.X_WD.linear().col(1);
      for (std::size_t i = 2500; i < r.samples.size(); ++i) {
        const double* f = r.samples[i].wrench.force;
        const Eigen::Vector3d force(f[0], f[1], f[2]);
        if (force.norm() < 0.3) continue;
        // The wall pushes up; friction may lean the force by its cone, tan 11.3 degrees = 0.2.
        EXPECT_GT(force.normalized().dot(up), std::cos(0.2)) << row.name << " tick " << i;
      }
      rows.push_back(row);
    }
  }
  report("saturation", rows);
}

}  // namespace
}  // namespace palpate::stability
