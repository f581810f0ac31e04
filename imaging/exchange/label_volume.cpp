#include "imaging/exchange/label_volume.h"

#include <bitset>

#include "imaging/exchange/grid_fit.h"
#include "imaging/exchange/slicer_keys.h"
#include "imaging/itk_image_file.h"
#include "imaging/volume_files.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

LabelGrid placed(const LabelGrid& stated, const GridFit& fit, const GridGeometry& geometry) {
  LabelGrid grid;
  grid.geometry = geometry;
  grid.labels.assign(geometry.voxelCount(), 0);
  const auto& dims = stated.geometry.dims;
  std::size_t from = 0;
  for (std::int32_t k = 0; k < dims[2]; ++k) {
    for (std::int32_t j = 0; j < dims[1]; ++j) {
      for (std::int32_t i = 0; i < dims[0]; ++i, ++from) {
        grid.labels[fit.index(i, j, k)] = stated.labels[from];
      }
    }
  }
  return grid;
}

/// Names and colours from the file, and "label-<value>" for values that have none.
std::vector<FoundLabel> namedValues(const LabelGrid& grid, const fs::path& file, bool& changed) {
  std::vector<FoundLabel> labels;
  if (const auto header = readItkHeader(VolumeFormat::Nrrd, file)) {
    labels = slicerLabels(header->texts, changed);
  }
  std::bitset<256> known;
  known.set(0);
  for (const FoundLabel& label : labels) known.set(label.value);
  for (const std::uint8_t value : grid.labels) {
    if (known.test(value)) continue;
    known.set(value);
    labels.push_back({labelName("", value, changed), value, std::nullopt});
  }
  return labels;
}

/// 3D Slicer stores segments that overlap as values of one voxel each.
Result<void> refuseLayers(const fs::path& file) {
  const auto header = readItkHeader(VolumeFormat::Nrrd, file);
  if (!header || (header->components == 1 && header->volumes == 1)) return {};
  return fail(inputRefused("The file holds its segments in layers.")
                  .inFile(file.string())
                  .inField("sizes")
                  .butFound(std::to_string(header->components * header->volumes) + " layers")
                  .wants("one layer, in which no segments overlap")
                  .advise("In 3D Slicer's Segmentations module choose Advanced, Collapse labelmap "
                          "layers, and save again; or export a DICOM segmentation."));
}

}  // namespace

Result<void> writeLabelVolume(const LabelGrid& labels, const LabelTable& table,
                              const fs::path& file) {
  return writeLabelFile(labels, file, slicerKeys(labels, table));
}

Result<FoundLabels> readLabelVolume(const fs::path& file, const GridGeometry& geometry) {
  if (auto flat = refuseLayers(file); !flat) return fail(flat.error());
  const auto stated = readLabelFile(file);
  if (!stated) return fail(stated.error());
  const auto fit = fitToGrid(statedGrid(stated->geometry), geometry, file, "origin, directions");
  if (!fit) return fail(fit.error());
  FoundLabels found;
  found.grid = placed(*stated, *fit, geometry);
  bool changed = false;
  found.labels = namedValues(found.grid, file, changed);
  if (changed) {
    found.warnings.emplace_back("A label's name is longer than 256 bytes and was cut.");
  }
  settleLabels(found);
  return found;
}

}  // namespace palpate
