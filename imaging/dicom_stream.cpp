#include "imaging/dicom_stream.h"

#include <dcmtk/dcmdata/dcistrmf.h>

#include <algorithm>
#include <cstdint>
#include <exception>

namespace palpate {
namespace {

// DCMTK reads a sequence in a sequence by calling itself, without end. This is a thousand levels or
// so; images have about five. A worker's stack is 4 MiB.
constexpr std::uintptr_t kMaxStack = std::uintptr_t{384} << 10U;
// A deflated data set above the first may not be this many times as large as its file. Images
// shrink to a half or a tenth; only made-up ones go near deflate's 1032.
constexpr std::uint64_t kFreeBytes = std::uint64_t{64} << 20U;
constexpr std::uint64_t kMaxInflation = 100;
constexpr std::int64_t kPiece = std::int64_t{1} << 20U;

std::uintptr_t stackPlace() {
  return reinterpret_cast<std::uintptr_t>(__builtin_frame_address(0));
}

/// DCMTK asks its stream before every element, on the stack that the element's depth has grown.
class LimitedStream : public DcmInputStream {
 public:
  explicit LimitedStream(const OFFilename& file)
      : DcmInputStream(&producer_), producer_(file), file_(file), fileBytes_(producer_.avail()) {}

  OFBool good() const override {
    const std::uintptr_t here = stackPlace();
    if (std::max(here, start_) - std::min(here, start_) > kMaxStack) tooDeep_ = true;
    return stopped() ? OFFalse : DcmInputStream::good();
  }
  OFCondition status() const override {
    return stopped() ? EC_CorruptedData : DcmInputStream::status();
  }
  OFBool eos() override { return stopped() ? OFTrue : DcmInputStream::eos(); }
  offile_off_t avail() override { return stopped() ? 0 : DcmInputStream::avail(); }
  offile_off_t read(void* to, offile_off_t count) override {
    return inPieces(count, [&](offile_off_t at, offile_off_t piece) {
      return DcmInputStream::read(static_cast<char*>(to) + at, piece);
    });
  }
  offile_off_t skip(offile_off_t count) override {
    return inPieces(count,
                    [&](offile_off_t, offile_off_t piece) { return DcmInputStream::skip(piece); });
  }
  OFCondition installCompressionFilter(E_StreamCompression filter) override {
    deflated_ = true;
    return DcmInputStream::installCompressionFilter(filter);
  }
  /// Where DCMTK finds a long value again; an inflated one is nowhere in the file.
  DcmInputStreamFactory* newFactory() const override {
    return deflated_ ? nullptr : new DcmInputFileStreamFactory(file_, tell());
  }

  [[nodiscard]] bool deflated() const { return deflated_; }
  [[nodiscard]] std::string limit() const {
    if (tooDeep_) return "its sequences lie in each other deeper than an image's";
    if (tooLarge_) return "its deflated data set inflates to far more than an image";
    return {};
  }

 private:
  [[nodiscard]] bool stopped() const { return tooDeep_ || tooLarge_; }

  template <class Move>
  offile_off_t inPieces(offile_off_t count, Move&& move) {
    if (!deflated_) return stopped() ? 0 : move(0, count);
    offile_off_t done = 0;
    while (done < count && !stopped()) {
      const offile_off_t piece = std::min<offile_off_t>(count - done, kPiece);
      const offile_off_t moved = move(done, piece);
      done += moved;
      inflated_ += static_cast<std::uint64_t>(moved);
      const auto used = static_cast<std::uint64_t>(fileBytes_ - producer_.avail());
      tooLarge_ = inflated_ > kFreeBytes && inflated_ / kMaxInflation > used;
      if (moved < piece) break;
    }
    return done;
  }

  DcmFileProducer producer_;
  OFFilename file_;
  offile_off_t fileBytes_;
  std::uintptr_t start_ = stackPlace();
  std::uint64_t inflated_ = 0;
  bool deflated_ = false, tooLarge_ = false;
  mutable bool tooDeep_ = false;
};

}  // namespace

DicomParse parseDicom(DcmFileFormat& format, const std::filesystem::path& file,
                      const DcmTagKey& stop) {
  LimitedStream stream{OFFilename(file.c_str())};
  DicomParse parse{stream.status(), {}};
  if (parse.condition.bad()) return parse;
  parse.condition = format.clear();
  if (parse.condition.bad()) return parse;
  format.transferInit();
  try {
    parse.condition =
        format.readUntilTag(stream, EXS_Unknown, EGL_noChange, DCM_MaxReadLength, stop);
  } catch (const std::exception&) {
    // DCMTK 3.6.7 throws at damaged values in the records of a DICOMDIR.
    parse.condition = EC_CorruptedData;
  }
  format.transferEnd();
  if (!stream.deflated()) parse.end = static_cast<std::uint64_t>(stream.tell());
  parse.limit = stream.limit();
  return parse;
}

}  // namespace palpate
