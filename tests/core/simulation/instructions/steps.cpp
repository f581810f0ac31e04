/// Steps of a simulation whose effects are off, for an instruction counter: a rod on a slab, above
/// it or pressed 0.3 mm in and sliding. Prints the last state's hash, so that two builds can be
/// seen to have done the same.
///
///     steps free|contact STEPS [friction]

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "core/scene/instrument_mesh.h"
#include "core/simulation/simulation.h"

namespace palpate {
namespace {

std::shared_ptr<const LabelGrid> slab() {
  auto grid = std::make_shared<LabelGrid>();
  grid->geometry.dims = {64, 64, 24};
  grid->labels.assign(grid->geometry.voxelCount(), 0);
  for (int k = 0; k < 12; ++k) {
    for (int j = 0; j < 64; ++j) {
      for (int i = 0; i < 64; ++i) grid->labels[grid->geometry.index(i, j, k)] = 1;
    }
  }
  return grid;
}

Instrument rod() {
  Instrument instrument;
  instrument.name = "rod";
  std::vector<CrossSection> sections;
  for (const double z : {0.0, 0.01, 0.02, 0.03, 0.04}) {
    CrossSection section;
    section.p_T.z() = z;
    section.halfAxes.setConstant(2e-3);
    sections.push_back(section);
  }
  instrument.mesh_T = *sweepSections(sections, 24);
  instrument.massProperties = *massPropertiesOf(instrument.mesh_T, 4500.0);
  return instrument;
}

int run(bool contact, int steps, bool friction) {
  Scene scene;
  scene.X_WD = Eigen::Isometry3d::Identity();
  scene.setting.friction = friction;
  Material bone;
  bone.name = "bone";
  const auto prepared =
      prepareScene(scene, slab(), {{"bone", 1, {227, 211, 177}, "bone"}}, {bone}, rod());
  if (!prepared) {
    std::fprintf(stderr, "%s\n", sentence(prepared.error()).c_str());
    return 1;
  }
  Simulation simulation(*prepared, CouplingGains{});
  std::size_t contacts = 0;
  for (int step = 0; step < steps; ++step) {
    DeviceSample sample;
    sample.index = static_cast<std::uint64_t>(step);
    sample.t = 1e-3 * step;
    const double angle = 1e-2 * step;
    const double height = contact ? 11.5e-3 - 0.3e-3 * std::min(1.0, step / 50.0) : 20e-3;
    sample.pose.p[0] = 32e-3 + 3e-3 * std::cos(angle);
    sample.pose.p[1] = 32e-3 + 3e-3 * std::sin(angle);
    sample.pose.p[2] = height;
    sample.v[0] = -3e-2 * std::sin(angle);
    sample.v[1] = 3e-2 * std::cos(angle);
    contacts += simulation.step(sample).contacts;
  }
  std::printf("contacts %.1f hash %016llx\n", static_cast<double>(contacts) / steps,
              static_cast<unsigned long long>(simulation.record().stateHash));
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  return palpate::run(std::strcmp(argv[1], "contact") == 0, std::atoi(argv[2]),
                      argc > 3 && std::strcmp(argv[3], "friction") == 0);
}
