#include "app/compare_reference.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "app/case_label.h"
#include "imaging/case_folder.h"
#include "imaging/invesalius.h"
#include "imaging/invesalius_masks.h"
#include "imaging/volume_files.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// All of the text as a whole number.
std::optional<int> wholeNumber(const std::string& text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

Error noSuchLabel(const fs::path& file, const std::string& found, std::string wanted,
                  std::string advice) {
  return inputRefused("The reference holds no such label.")
      .inFile(file.string())
      .inField("--reference-label")
      .butFound(found)
      .wants(std::move(wanted))
      .advise(std::move(advice));
}

Result<Reference> fromCase(const ReferenceRequest& request) {
  Reference reference;
  reference.name = request.label.value_or(request.comparedLabel);
  const auto table = readCaseLabelTable(request.path);
  if (!table) return fail(table.error());
  const auto value = labelValue(*table, reference.name);
  if (!value) {
    Error error = value.error();
    error.inFile(request.path.string()).inField("--reference-label");
    return fail(error);
  }
  reference.value = *value;
  auto grid = readCaseLabels(request.path);
  if (!grid) return fail(grid.error());
  reference.grid = std::move(*grid);
  return reference;
}

/// The mask of that name, else of that number.
Result<std::size_t> maskIndex(const std::vector<InvesaliusMask>& masks,
                              const std::optional<std::string>& label, const fs::path& file) {
  if (masks.empty()) {
    return fail(inputRefused("The InVesalius project holds no mask.")
                    .inFile(file.string())
                    .inField("main.plist: masks")
                    .butFound("nothing")
                    .wants("a mask")
                    .advise("Make one in InVesalius and save the project."));
  }
  if (!label) return std::size_t{0};
  const auto named = std::find_if(masks.begin(), masks.end(),
                                  [&](const InvesaliusMask& mask) { return mask.name == *label; });
  if (named != masks.end()) return static_cast<std::size_t>(named - masks.begin());
  const std::optional<int> number = wholeNumber(*label);
  if (number && *number >= 1 && static_cast<std::size_t>(*number) <= masks.size()) {
    return static_cast<std::size_t>(*number) - 1;
  }
  return fail(noSuchLabel(file, *label, "a mask's name, or 1 to " + std::to_string(masks.size()),
                          "InVesalius lists the masks by name."));
}

Result<Reference> fromInvesalius(const ReferenceRequest& request) {
  const auto masks = listInvesaliusMasks(request.path);
  if (!masks) return fail(masks.error());
  const auto index = maskIndex(*masks, request.label, request.path);
  if (!index) return fail(index.error());
  Reference reference;
  reference.name = request.label.value_or("mask 1");
  auto grid = readInvesaliusMask(request.path, (*masks)[*index]);
  if (!grid) return fail(grid.error());
  reference.grid = std::move(*grid);
  GridGeometry& own = reference.grid.geometry;
  const GridGeometry& wanted = request.geometry;
  const bool sameVoxels = own.dims == wanted.dims &&
                          (own.spacing - wanted.spacing).cwiseAbs().maxCoeff() < kSameGeometry_m;
  if (sameVoxels && own.cornerDistance(wanted) > kSameGeometry_m) {
    own = wanted;
    reference.warnings.emplace_back(
        "The project stores no position in the patient: its voxels are compared with the case's "
        "one by one.");
  }
  return reference;
}

/// The values that are there, for the message: at most eight of them.
std::string valuesIn(const LabelGrid& grid) {
  std::array<bool, 256> there{};
  for (const std::uint8_t label : grid.labels) there[label] = true;
  std::string text;
  int listed = 0;
  for (std::size_t value = 1; value < there.size(); ++value) {
    if (!there[value]) continue;
    if (++listed > 8) return text + ", ...";
    text += (text.empty() ? "" : ", ") + std::to_string(value);
  }
  return text.empty() ? "a volume with other values than 0" : "one of " + text;
}

Result<Reference> fromVolume(const ReferenceRequest& request) {
  Reference reference;
  reference.name = request.label.value_or("non-zero");
  if (request.label) {
    const std::optional<int> number = wholeNumber(*request.label);
    if (!number || *number < 1 || *number > 255) {
      return fail(noSuchLabel(request.path, *request.label, "a value from 1 to 255",
                              "A label volume has values and no names; without "
                              "--reference-label all but 0 counts."));
    }
    reference.value = static_cast<std::uint8_t>(*number);
  }
  auto grid = readLabelFile(request.path);
  if (!grid) return fail(grid.error());
  reference.grid = std::move(*grid);
  const auto& labels = reference.grid.labels;
  const bool holds = std::any_of(labels.begin(), labels.end(), [&](std::uint8_t label) {
    return reference.value ? label == *reference.value : label != 0;
  });
  if (!holds) {
    return fail(noSuchLabel(request.path, reference.name, valuesIn(reference.grid),
                            "Choose another value or another file."));
  }
  return reference;
}

}  // namespace

Result<Reference> readReference(const ReferenceRequest& request) {
  std::error_code ec;
  if (fs::is_directory(request.path, ec)) return fromCase(request);
  if (fs::is_regular_file(request.path, ec) && isInvesaliusProject(request.path)) {
    return fromInvesalius(request);
  }
  return fromVolume(request);
}

}  // namespace palpate
