#include "core/simulation/fingerprint.h"

#include <algorithm>

#include "core/simulation/bits.h"

namespace palpate {
namespace {

std::uint64_t ofGeometry(const GridGeometry& geometry, std::uint64_t seed) {
  BitRow<32> row;
  for (const auto n : geometry.dims) row.add(n);
  for (int axis = 0; axis < 3; ++axis) row.add(geometry.spacing[axis]);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) row.add(geometry.X_PV.matrix()(i, j));
  }
  return row.hash(seed);
}

std::uint64_t ofLabels(const LabelGrid& grid, const FeltLabels& felt, std::uint64_t seed) {
  std::array<std::uint8_t, 4096> block{};
  for (std::size_t at = 0; at < grid.labels.size(); at += block.size()) {
    const std::size_t count = std::min(block.size(), grid.labels.size() - at);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint8_t label = grid.labels[at + i];
      block[i] = felt[label] ? label : std::uint8_t{0};
    }
    seed = hashBits(block.data(), count, seed);
  }
  return seed;
}

std::uint64_t ofInstrument(const Instrument& instrument, std::uint64_t seed) {
  for (const auto& vertex : instrument.mesh_T.vertices) {
    seed = hashBits(vertex.data(), 3 * sizeof(double), seed);
  }
  for (const auto& triangle : instrument.mesh_T.triangles) {
    seed = hashBits(triangle.data(), sizeof(triangle), seed);
  }
  BitRow<16> row;
  const MassProperties& mass = instrument.massProperties;
  row.add(mass.mass);
  for (int axis = 0; axis < 3; ++axis) row.add(mass.p_TC[axis]);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) row.add(mass.I_C(i, j));
  }
  row.add(instrument.shellSpacing);
  return row.hash(seed);
}

std::uint64_t ofSetting(const SimulationSetting& setting, std::uint64_t seed) {
  BitRow<18> row;
  row.add(static_cast<std::uint16_t>(setting.tree.branching));
  row.add(static_cast<std::uint8_t>(setting.tree.leaf));
  row.add(setting.tree.surfaceOnly);
  row.add(static_cast<std::uint8_t>(setting.query.method));
  row.add(setting.query.tightSpheres);
  row.add(setting.query.oneChildSkip);
  row.add(setting.query.sideOffset);
  row.add(setting.query.stopLevel);
  row.add(setting.query.contactBudget);
  // Only where it is used: sessions from before it keep their fingerprints.
  if (setting.query.perceptualBound > 0.0) row.add(setting.query.perceptualBound);
  row.add(setting.shellSpacing);
  row.add(setting.stepPeriod);
  row.add(setting.contactCapacity);
  row.add(setting.solverIterations);
  row.add(setting.friction);
  if (setting.couplingShare != 1.0) row.add(setting.couplingShare);
  return row.hash(seed);
}

std::uint64_t ofSurface(const SurfaceTable& surface, const FeltLabels& felt, std::uint64_t seed) {
  for (std::size_t label = 1; label < felt.size(); ++label) {
    if (!felt[label]) continue;
    BitRow<4> row;
    row.add(surface[label].friction);
    row.add(surface[label].restitution);
    seed = row.hash(seed);
  }
  return seed;
}

/// Only where there are any: scenes without bodies keep their fingerprints.
std::uint64_t ofBodies(const PreparedScene& prepared, const FeltLabels& felt, std::uint64_t seed) {
  for (const PreparedBody& body : prepared.bodies) {
    BitRow<8> row;
    row.add(body.label);
    row.add(body.massProperties.mass);
    for (int axis = 0; axis < 3; ++axis) row.add(body.massProperties.p_TC[axis]);
    seed = ofSurface(body.surface, felt, row.hash(seed));
  }
  if (prepared.bodies.empty()) return seed;
  BitRow<4> row;
  for (int axis = 0; axis < 3; ++axis) row.add(prepared.scene.surroundings.gravity[axis]);
  row.add(prepared.scene.surroundings.drag);
  return row.hash(seed);
}

/// Only where something is left out: other scenes keep their fingerprints. What is outside of the
/// region is not among the labels.
std::uint64_t ofReach(const PreparedScene& prepared, std::uint64_t seed) {
  const ReachSaving& saving = prepared.saving;
  if (saving.filledVoxels + saving.outsideDevice == 0) return seed;
  BitRow<2> row;
  row.add(static_cast<std::uint64_t>(saving.filledVoxels));
  row.add(static_cast<std::uint64_t>(saving.outsideDevice));
  return row.hash(seed);
}

}  // namespace

std::uint64_t fingerprintOf(const PreparedScene& prepared, const FeltLabels& felt) {
  std::uint64_t hash = ofGeometry(prepared.labels->geometry, 0);
  hash = ofLabels(*prepared.labels, felt, hash);
  hash = ofSurface(prepared.instrumentSurface, felt, hash);
  hash = ofBodies(prepared, felt, hash);
  hash = ofInstrument(prepared.instrument, hash);
  hash = ofReach(prepared, hash);
  return ofSetting(prepared.scene.setting, hash);
}

}  // namespace palpate
