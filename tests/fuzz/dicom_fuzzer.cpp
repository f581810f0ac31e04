// A DICOM file, alone or in a series, is refused with a sentence that names nobody, or it gives a
// volume that is whole and finite.

#include <stdlib.h>
#include <tbb/global_control.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "imaging/dicom_import.h"
#include "imaging/dicom_list.h"
#include "tests/fuzz/fuzz_require.h"
#include "tests/imaging/dicom_bytes.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// In memory where the system has such a place. Goes with the process, if that ends by itself: a
/// crash, and the processes of -fork, leave it behind with the last input.
class FuzzFolder {
 public:
  FuzzFolder() {
    const fs::path memory = "/dev/shm";
    std::string pattern =
        ((fs::is_directory(memory) ? memory : fs::temp_directory_path()) / "palpate-fuzz-XXXXXX")
            .string();
    require(::mkdtemp(pattern.data()) != nullptr, "there is a folder for the files");
    path = pattern;
  }
  ~FuzzFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  fs::path path;
};

void write(const fs::path& file, std::string_view bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<long>(bytes.size()));
}

/// The slice of the seeds' series at this height, whole.
std::string neighbour(const char* position) {
  test::DicomBytes slice;
  slice.position = position;
  slice.pixels = test::plainPixels(128);
  return slice.file();
}

enum class Setting : std::uint8_t { Alone, Copied, Stack, UnevenStack };

fs::path layOut(std::string_view bytes, Setting setting) {
  static const FuzzFolder alone;
  static const FuzzFolder series;
  if (setting == Setting::Alone) {
    write(alone.path / "a", bytes);
    return alone.path / "a";
  }
  for (const char* name : {"b", "c", "d"}) fs::remove(series.path / name);
  write(series.path / "a", bytes);
  if (setting == Setting::Copied) write(series.path / "b", bytes);
  write(series.path / "c", neighbour("0\\0\\2"));
  if (setting == Setting::UnevenStack) write(series.path / "d", neighbour("0.4\\0\\9"));
  return series.path;
}

// The seeds' names are in small letters, codes of DICOM are not: no code can be taken for a name.
void requireNameless(const std::string& text) {
  for (const char* part : {"quince", "medlar"}) {
    require(text.find(part) == std::string::npos, "a message names no patient");
  }
}

void checkRefusal(const Error& error) {
  require(error.kind == ErrorKind::InputRefused, "a file is refused as an input");
  require(!error.message.empty() && error.advice, "a refusal has a sentence and an advice");
  requireNameless(error.message);
  requireNameless(error.field.value_or(""));
  requireNameless(error.expected.value_or(""));
  requireNameless(*error.advice);
}

void checkScan(const ImportedScan& scan) {
  const GridGeometry& g = scan.volume.geometry;
  require(g.dims[0] > 0 && g.dims[1] > 0 && g.dims[2] > 0, "a volume has voxels");
  require(g.spacing.allFinite() && g.spacing.minCoeff() > 0, "spacings are lengths");
  require(g.X_PV.matrix().allFinite(), "the pose is finite");
  const Eigen::Matrix3d R = g.X_PV.linear();
  require((R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-9,
          "axes are orthonormal");
  require(scan.volume.size() == g.voxelCount(), "voxels are as many as the dimensions say");
  for (const float v : scan.volume.float32) require(std::isfinite(v), "values are finite");
  require(!scan.patientName && !scan.patientId, "names are left out");
  for (const std::string& text : scan.warnings) requireNameless(text);
  for (const std::string& text : scan.repairs) requireNameless(text);
}

}  // namespace
}  // namespace palpate

/// Where DCMTK throws while it reads, it loses what it read so far.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libdcmdata\n";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  // One thread: the same input takes the same way.
  static const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const unsigned choice = size > 0 ? data[size - 1 - size / 3] : 0U;
  // Half of the inputs alone: the way of one file is what most is about.
  const auto setting = choice % 8 < 4 ? Setting::Alone : static_cast<Setting>(choice % 4);
  ImportRequest request;
  request.path = layOut(bytes, setting);
  request.repairTilt = request.repairSpacing = choice % 2 == 1;
  const auto scan = importDicom(request, {});
  if (scan) {
    checkScan(*scan);
  } else {
    checkRefusal(scan.error());
  }
  if (choice % 16 == 0) {
    const auto list = listDicomSeries(request.path, {});
    if (!list) checkRefusal(list.error());
  }
  return 0;
}
