#include "app/grid_report.h"

#include <cmath>

#include "app/text_table.h"
#include "core/geometry/units.h"

namespace palpate {
namespace {

using nlohmann::ordered_json;

/// Metres to millimetres and back costs a bit in the last place; nine decimals of a millimetre are
/// below any scanner and give 0.95703, not 0.9570300000000001.
double shownMillimetres(double metresValue) {
  return std::round(millimetres(metresValue) * 1e9) / 1e9 + 0.0;
}

ordered_json vectorInMm(const Eigen::Vector3d& v) {
  return {shownMillimetres(v.x()), shownMillimetres(v.y()), shownMillimetres(v.z())};
}

}  // namespace

void addGridFields(ordered_json& json, const GridGeometry& geometry) {
  json["dims"] = geometry.dims;
  json["spacing_mm"] = vectorInMm(geometry.spacing);
  json["origin_mm"] = vectorInMm(geometry.X_PV.translation());
  ordered_json direction = ordered_json::array();
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      direction.push_back(geometry.X_PV.linear()(row, column) + 0.0);  // no -0
    }
  }
  json["direction"] = direction;
}

void addNullGridFields(ordered_json& json) {
  for (const char* field : {"dims", "spacing_mm", "origin_mm", "direction"}) json[field] = nullptr;
}

std::string gridSentence(const GridGeometry& geometry) {
  const auto& [nx, ny, nz] = geometry.dims;
  const Eigen::Vector3d& s = geometry.spacing;
  return std::to_string(nx) + " × " + std::to_string(ny) + " × " + std::to_string(nz) +
         " voxels of " + decimal(millimetres(s.x()), 3) + " × " + decimal(millimetres(s.y()), 3) +
         " × " + decimal(millimetres(s.z()), 3) + " mm";
}

}  // namespace palpate
