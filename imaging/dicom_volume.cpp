#include "imaging/dicom_volume.h"

#include <openssl/evp.h>
#include <sys/mman.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>

#include "imaging/dicom_pixels.h"

namespace palpate {
namespace {

constexpr std::size_t kBatch = 16;  // files between two words of progress

/// Which frames of a file are wanted, and where they go.
struct FileWork {
  std::size_t file = 0;
  std::map<std::uint32_t, std::size_t> sliceOfFrame;
};

std::vector<FileWork> workOf(const DicomStack& stack) {
  std::map<std::size_t, FileWork> works;
  for (std::size_t slice = 0; slice < stack.slices.size(); ++slice) {
    const FrameRef& ref = stack.slices[slice];
    FileWork& work = works[ref.file];
    work.file = ref.file;
    work.sliceOfFrame[static_cast<std::uint32_t>(ref.frame)] = slice;
  }
  std::vector<FileWork> out;
  for (auto& entry : works) out.push_back(std::move(entry.second));
  return out;
}

bool isInt16(double v) {
  return v >= -32768.0 && v <= 32767.0 && v == std::trunc(v);
}

/// A volume's first touch costs a tenth on pages of 2 MiB, where the system has them.
template <class T>
void resizeOnLargePages(std::vector<T>& values, std::size_t count) {
  values.reserve(count);
  constexpr std::uintptr_t kPage = std::uintptr_t{2} << 20U;
  const auto begin = (reinterpret_cast<std::uintptr_t>(values.data()) + kPage - 1) / kPage * kPage;
  const auto end = (reinterpret_cast<std::uintptr_t>(values.data()) + count * sizeof(T));
  if (end > begin + kPage) {
    (void)::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
  }
  values.resize(count);
}

/// One attempt at loading into int16 or float32.
class Loader {
 public:
  Loader(const std::vector<DicomFile>& files, const DicomStack& stack, VoxelType type)
      : files_(files), slice_(stack.geometry.voxelCount() / stack.slices.size()) {
    volume.geometry = stack.geometry;
    volume.type = type;
    volume.modality = modalityOf(files, stack);
    if (type == VoxelType::Int16) {
      resizeOnLargePages(volume.int16, stack.geometry.voxelCount());
    } else {
      resizeOnLargePages(volume.float32, stack.geometry.voxelCount());
    }
  }

  void load(const FileWork& work) {
    const DicomFile& file = files_[work.file];
    const auto facts = decodeDicomFrames(file, [&](std::uint32_t frame, auto values) {
      const auto slice = work.sliceOfFrame.find(frame);
      if (slice != work.sliceOfFrame.end()) store(file.frames[frame], values, slice->second);
    });
    if (!facts) {
      const std::lock_guard lock(errorMutex_);
      // The first in the order of files, whichever thread met it: the same words every time.
      if (!error_ || work.file < errorFile_) {
        error_ = facts.error();
        errorFile_ = work.file;
      }
    } else if (facts->lossy || file.lossy) {
      lossy = true;
    }
  }

  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

  Volume volume;
  std::atomic<bool> needsFloat{false}, notFinite{false}, lossy{false};

 private:
  void store(const DicomFrame& frame, std::span<const std::int32_t> values, std::size_t slice) {
    const std::size_t at = slice * slice_;
    for (std::size_t i = 0; i < slice_; ++i) {
      const double value = static_cast<double>(values[i]) * frame.slope + frame.intercept;
      if (volume.type == VoxelType::Int16) {
        if (!isInt16(value)) {
          needsFloat = true;
          return;
        }
        volume.int16[at + i] = static_cast<std::int16_t>(value);
      } else {
        const auto number = static_cast<float>(value);
        if (!std::isfinite(number)) notFinite = true;
        volume.float32[at + i] = number;
      }
    }
  }

  const std::vector<DicomFile>& files_;
  std::size_t slice_;
  std::mutex errorMutex_;
  std::optional<Error> error_;
  std::size_t errorFile_ = 0;
};

Result<LoadedStack> attempt(Loader& loader, const std::vector<FileWork>& works,
                            const Progress& progress) {
  for (std::size_t from = 0; from < works.size(); from += kBatch) {
    if (progress.cancelled()) return fail(cancelled());
    progress(static_cast<double>(from) / static_cast<double>(works.size()), "Reading the images");
    tbb::parallel_for(from, std::min(from + kBatch, works.size()),
                      [&](std::size_t w) { loader.load(works[w]); });
    if (loader.error()) return fail(*loader.error());
    if (loader.needsFloat) return LoadedStack{};
  }
  if (loader.notFinite) {
    return fail(inputRefused("The rescaled values of the series are too large to be numbers.")
                    .inField("RescaleSlope, RescaleIntercept")
                    .advise("Copy the series again from where it came."));
  }
  return LoadedStack{std::move(loader.volume), loader.lossy};
}

std::string digestOf(const DicomFrame& frame, std::span<const std::int32_t> values) {
  std::vector<double> rescaled;
  rescaled.reserve(values.size());
  for (const std::int32_t v : values) {
    // + 0.0: zero has one sign only.
    rescaled.push_back(static_cast<double>(v) * frame.slope + frame.intercept + 0.0);
  }
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int length = 0;
  EVP_Digest(rescaled.data(), rescaled.size() * sizeof(double), digest.data(), &length,
             EVP_sha256(), nullptr);
  return {digest.begin(), digest.begin() + length};
}

}  // namespace

Result<LoadedStack> loadStack(const std::vector<DicomFile>& files, const DicomStack& stack,
                              const Progress& progress) {
  const auto works = workOf(stack);
  const bool whole = std::all_of(stack.slices.begin(), stack.slices.end(), [&](const FrameRef& r) {
    const DicomFrame& f = files[r.file].frames[r.frame];
    return f.slope == std::trunc(f.slope) && f.intercept == std::trunc(f.intercept);
  });
  if (whole) {
    Loader loader(files, stack, VoxelType::Int16);
    auto loaded = attempt(loader, works, progress);
    if (!loaded || !loader.needsFloat) return loaded;
  }
  Loader loader(files, stack, VoxelType::Float32);
  auto loaded = attempt(loader, works, progress);
  if (loaded) narrowToInt16IfExact(loaded->volume);
  return loaded;
}

Result<ImageDigests> imageDigests(const std::vector<DicomFile>& files,
                                  const std::vector<FrameRef>& frames) {
  std::map<std::size_t, std::set<std::size_t>> framesOf;
  for (const FrameRef& ref : frames) framesOf[ref.file].insert(ref.frame);
  ImageDigests digests;
  for (const auto& entry : framesOf) {
    const std::size_t file = entry.first;
    const std::set<std::size_t>& wanted = entry.second;
    const auto facts = decodeDicomFrames(files[file], [&](std::uint32_t number, auto values) {
      if (wanted.contains(number)) {
        digests[{file, number}] = digestOf(files[file].frames[number], values);
      }
    });
    if (!facts) return fail(facts.error());
  }
  return digests;
}

}  // namespace palpate
