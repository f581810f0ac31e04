#include "imaging/case_info.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/base/toml.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kVersion = 1;

toml::array arrayOf(const std::vector<std::string>& texts) {
  toml::array array;
  for (const auto& text : texts) array.push_back(text);
  return array;
}

/// Reads one table, noting the first thing that is wrong; every key must be asked for.
class TableReader {
 public:
  TableReader(const toml::table& table, std::string where, const fs::path& file)
      : table_(table), where_(std::move(where)), file_(file) {}

  template <class T>
  T required(const char* key, const char* wanted) {
    known_.emplace_back(key);
    if (const auto value = table_[key].value<T>()) return *value;
    refuse(key, table_.contains(key) ? "another type of value" : "nothing", wanted);
    return T{};
  }
  std::optional<std::string> optionalText(const char* key) {
    known_.emplace_back(key);
    return table_[key].value<std::string>();
  }
  std::vector<double> numbers(const char* key, std::size_t count) {
    known_.emplace_back(key);
    std::vector<double> out;
    if (const toml::array* array = table_[key].as_array()) {
      for (const auto& item : *array) out.push_back(item.value<double>().value_or(NAN));
    }
    const bool fits = out.size() == count && std::all_of(out.begin(), out.end(),
                                                         [](double v) { return std::isfinite(v); });
    if (!fits) {
      refuse(key, table_.contains(key) ? "other values" : "nothing",
             std::to_string(count) + " numbers");
      out.assign(count, 1.0);
    }
    return out;
  }
  std::vector<std::string> texts(const char* key) {
    known_.emplace_back(key);
    std::vector<std::string> out;
    if (const toml::array* array = table_[key].as_array()) {
      for (const auto& item : *array) out.push_back(item.value_or(std::string()));
    } else {
      refuse(key, "nothing", "a list of sentences");
    }
    return out;
  }
  const toml::table& sub(const char* key) {
    static const toml::table kEmpty;
    known_.emplace_back(key);
    if (const toml::table* table = table_[key].as_table()) return *table;
    refuse(key, "nothing", "a table");
    return kEmpty;
  }
  void refuseUnknown() {
    for (const auto& [key, value] : table_) {
      const std::string name(key.str());
      if (std::find(known_.begin(), known_.end(), name) == known_.end()) {
        refuse(name.c_str(), "a key that this version does not know", "no such key");
      }
    }
  }
  void refuse(const char* key, std::string found, std::string wanted) {
    if (error) return;
    error = inputRefused("The case is damaged or from another version of Palpate.")
                .inFile(file_.string())
                .inField(where_ + key)
                .butFound(std::move(found))
                .wants(std::move(wanted))
                .advise("Import the scan again.");
  }
  std::optional<Error> error;

 private:
  const toml::table& table_;
  std::string where_;
  const fs::path& file_;
  std::vector<std::string> known_;
};

GridGeometry readGeometry(TableReader& t) {
  GridGeometry geometry;
  const auto dims = t.numbers("dims", 3);
  const auto spacing = t.numbers("spacing_mm", 3);
  const auto origin = t.numbers("origin_mm", 3);
  const auto direction = t.numbers("direction", 9);
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    if (!(dims[a] >= 1.0 && dims[a] <= 65536.0 && dims[a] == std::trunc(dims[a]))) {
      t.refuse("dims", "other values", "three counts of voxels");
      break;
    }
    if (!(spacing[a] > 0.0)) t.refuse("spacing_mm", "other values", "three positive lengths");
    geometry.dims[a] = static_cast<std::int32_t>(dims[a]);
    geometry.spacing[axis] = spacing[a] * 1e-3;
    geometry.X_PV.translation()[axis] = origin[a] * 1e-3;
    for (std::size_t r = 0; r < 3; ++r) {
      geometry.X_PV.linear()(static_cast<Eigen::Index>(r), axis) = direction[3 * a + r];
    }
  }
  const Eigen::Matrix3d R = geometry.X_PV.linear();
  if (!(R * R.transpose()).isIdentity(1e-6) || R.determinant() < 0.0) {
    t.refuse("direction", "axes that are not a right-handed frame", "three unit axes");
  }
  return geometry;
}

}  // namespace

std::string caseInfoText(const CaseInfo& info) {
  toml::array dims;
  toml::array spacing;
  toml::array origin;
  toml::array direction;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    dims.push_back(info.geometry.dims[a]);
    spacing.push_back(info.geometry.spacing[axis] * 1e3);
    origin.push_back(info.geometry.X_PV.translation()[axis] * 1e3);
    for (Eigen::Index r = 0; r < 3; ++r) direction.push_back(info.geometry.X_PV.linear()(r, axis));
  }
  toml::table table{
      {"format", "palpate-case"},
      {"version", kVersion},
      {"pseudonym", info.pseudonym},
      {"source", toml::table{{"format", info.sourceFormat},
                             {"modality", info.modality},
                             {"description", info.description},
                             {"lossy", info.lossy},
                             {"warnings", arrayOf(info.warnings)},
                             {"repairs", arrayOf(info.repairs)}}},
      {"volume",
       toml::table{{"dims", dims},
                   {"spacing_mm", spacing},
                   {"origin_mm", origin},
                   {"direction", direction},
                   {"voxel_type", info.voxelType == VoxelType::Int16 ? "int16" : "float32"},
                   {"voxels_sha256", info.voxelsSha256}}}};
  if (info.patientName) table.insert("patient_name", *info.patientName);
  if (info.patientId) table.insert("patient_id", *info.patientId);
  std::ostringstream out;
  out << "# A Palpate case: what was imported, and how. Written by the program.\n"
      << toml::toml_formatter(table) << "\n";
  return out.str();
}

Result<CaseInfo> parseCaseInfo(const fs::path& file) {
  toml::table table;
  try {
    table = toml::parse_file(file.string());
  } catch (const toml::parse_error& e) {
    return fail(inputRefused("The case is damaged: case.toml is not TOML.")
                    .inFile(file.string())
                    .inField("line " + std::to_string(e.source().begin.line))
                    .butFound(std::string(e.description()))
                    .advise("Import the scan again."));
  }
  TableReader top(table, "", file);
  if (top.required<std::string>("format", "palpate-case") != "palpate-case") {
    top.refuse("format", "another format", "palpate-case");
  }
  const auto version = top.required<std::int64_t>("version", "1");
  if (version != kVersion) top.refuse("version", std::to_string(version), "1");
  CaseInfo info;
  info.pseudonym = top.required<std::string>("pseudonym", "a text");
  info.patientName = top.optionalText("patient_name");
  info.patientId = top.optionalText("patient_id");

  TableReader source(top.sub("source"), "source.", file);
  info.sourceFormat = source.required<std::string>("format", "a text");
  info.modality = source.required<std::string>("modality", "a text");
  info.description = source.required<std::string>("description", "a text");
  info.lossy = source.required<bool>("lossy", "true or false");
  info.warnings = source.texts("warnings");
  info.repairs = source.texts("repairs");

  TableReader volume(top.sub("volume"), "volume.", file);
  info.geometry = readGeometry(volume);
  const auto type = volume.required<std::string>("voxel_type", "int16 or float32");
  if (type != "int16" && type != "float32") volume.refuse("voxel_type", type, "int16 or float32");
  info.voxelType = type == "float32" ? VoxelType::Float32 : VoxelType::Int16;
  info.voxelsSha256 = volume.required<std::string>("voxels_sha256", "64 hexadecimal digits");

  for (TableReader* reader : {&top, &source, &volume}) {
    reader->refuseUnknown();
    if (reader->error) return fail(*reader->error);
  }
  return info;
}

}  // namespace palpate
