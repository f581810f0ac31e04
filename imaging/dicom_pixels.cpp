#include "imaging/dicom_pixels.h"

#include <dcmtk/dcmdata/dcpixel.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>

#include "imaging/code_stream_size.h"
#include "imaging/dicom_stream.h"
#include "imaging/dicom_toolkit.h"
#include "imaging/jpeg2000.h"
#include "imaging/transfer_syntax.h"

namespace palpate {
namespace {

struct ModalityLut {
  std::int32_t first = 0;
  std::vector<std::int32_t> values;
};

Error cannotDecode(const DicomFile& file, const std::string& why) {
  return inputRefused("A DICOM image could not be decoded: " + why + ".")
      .inFile(file.path.string())
      .inField("PixelData, " + transferSyntaxName(file.transferSyntax))
      .advise("Copy the file again from where it came, or have the archive send it uncompressed.");
}

std::size_t pixelsPerFrame(const DicomFile& file) {
  return static_cast<std::size_t>(file.rows) * file.columns;
}

/// From the bits of a cell to the number: the stored bits end at the high bit; whatever a scanner
/// left in the others (overlays, padding) is not part of it.
class BitReader {
 public:
  explicit BitReader(const DicomFile& file)
      : shift_(file.highBit + 1 - file.bitsStored),
        bits_(file.bitsStored),
        mask_(file.bitsStored == 32 ? 0xFFFFFFFFU : (1U << file.bitsStored) - 1U),
        signed_(file.isSigned) {}
  [[nodiscard]] std::int32_t operator()(std::uint32_t cell) const {
    const std::uint32_t value = (cell >> shift_) & mask_;
    if (!signed_ || bits_ == 32) return static_cast<std::int32_t>(value);
    const std::uint32_t sign = 1U << (bits_ - 1U);
    return static_cast<std::int32_t>(value ^ sign) - static_cast<std::int32_t>(sign);
  }

 private:
  std::uint32_t shift_, bits_, mask_;
  bool signed_;
};

/// Cells of a frame from little-endian bytes. Packed 12 bits: two pixels in three bytes, low first.
void readCells(const DicomFile& file, const std::uint8_t* bytes, std::size_t firstPixel,
               std::vector<std::int32_t>& out) {
  const BitReader number(file);
  const std::size_t count = pixelsPerFrame(file);
  out.resize(count);
  switch (file.bitsAllocated) {
    case 8:
      for (std::size_t i = 0; i < count; ++i) out[i] = number(bytes[firstPixel + i]);
      break;
    case 12:
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t p = firstPixel + i;
        const std::uint8_t* pair = bytes + p / 2 * 3;
        // The last of an odd number of pixels has no third byte.
        out[i] = number(p % 2 == 0 ? pair[0] | (pair[1] & 15U) << 8U
                                   : static_cast<std::uint32_t>(pair[1] >> 4U | pair[2] << 4U));
      }
      break;
    case 16:
      for (std::size_t i = 0; i < count; ++i) {
        std::uint16_t cell = 0;
        std::memcpy(&cell, bytes + 2 * (firstPixel + i), 2);
        out[i] = number(cell);
      }
      break;
    default:
      for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t cell = 0;
        std::memcpy(&cell, bytes + 4 * (firstPixel + i), 4);
        out[i] = number(cell);
      }
  }
}

/// Whether numbers of 32 bits without sign went beyond what std::int32_t holds.
bool tooLarge(const DicomFile& file, const std::vector<std::int32_t>& values) {
  return file.bitsStored == 32 && !file.isSigned &&
         std::any_of(values.begin(), values.end(), [](std::int32_t v) { return v < 0; });
}

std::size_t bytesForPixels(const DicomFile& file, std::size_t pixels) {
  return file.bitsAllocated == 12 ? (pixels * 3 + 1) / 2 : pixels * file.bitsAllocated / 8;
}

bool readLut(DcmItem& dataset, const DicomFile& file, ModalityLut& lut) {
  DcmItem* item = nullptr;
  double entries = 0.0;
  double first = 0.0;
  const Uint16* data = nullptr;
  unsigned long count = 0;
  if (dataset.findAndGetSequenceItem(DCM_ModalityLUTSequence, item, 0).bad() ||
      !dicomNumber(*item, DCM_LUTDescriptor, entries, 0) ||
      !dicomNumber(*item, DCM_LUTDescriptor, first, 1) ||
      item->findAndGetUint16Array(DCM_LUTData, data, &count).bad() || data == nullptr) {
    return false;
  }
  // Numbers of sixteen bits, whatever the file writes them as.
  if (entries < 0.0 || entries > 65536.0 || std::abs(first) > 65536.0) return false;
  const auto wanted = entries == 0.0 ? 65536UL : static_cast<unsigned long>(entries);
  if (count < wanted) return false;
  lut.first = file.isSigned ? static_cast<std::int16_t>(static_cast<std::int32_t>(first))
                            : static_cast<std::int32_t>(first);
  lut.values.assign(data, data + wanted);
  return true;
}

void applyLut(const ModalityLut& lut, std::vector<std::int32_t>& values) {
  const auto last = static_cast<std::int64_t>(lut.values.size()) - 1;
  for (std::int32_t& v : values) {
    const std::int64_t at =
        std::clamp<std::int64_t>(static_cast<std::int64_t>(v) - lut.first, 0, last);
    v = lut.values[static_cast<std::size_t>(at)];
  }
}

/// Hands frames on, through the LUT when there is one.
struct FrameSink {
  const FrameVisitor& visit;
  ModalityLut lut;
  void operator()(std::uint32_t frame, std::vector<std::int32_t>& values) const {
    if (!lut.values.empty()) applyLut(lut, values);
    visit(frame, values);
  }
};

/// None where a damaged file states another kind of value there.
DcmPixelData* pixelDataOf(DcmDataset& dataset) {
  DcmElement* element = nullptr;
  (void)dataset.findAndGetElement(DCM_PixelData, element);
  return dynamic_cast<DcmPixelData*>(element);
}

/// The code streams of the frames: one fragment each, or cut where a stream begins (FF4F, FFD8,
/// or the box of a JP2 file).
Result<std::vector<std::vector<std::uint8_t>>> codeStreams(DcmPixelData& pixels,
                                                           const DicomFile& file) {
  E_TransferSyntax syntax = EXS_Unknown;
  const DcmRepresentationParameter* parameter = nullptr;
  pixels.getOriginalRepresentationKey(syntax, parameter);
  DcmPixelSequence* sequence = nullptr;
  if (pixels.getEncapsulatedRepresentation(syntax, parameter, sequence).bad() ||
      sequence == nullptr || sequence->card() < 2) {
    return fail(cannotDecode(file, "it holds no code stream"));
  }
  const std::size_t frames = file.frames.size();
  const bool oneEach = sequence->card() - 1 == frames;
  std::vector<std::vector<std::uint8_t>> streams;
  // From one to the next, after the table of offsets: getItem() counts from the first every time.
  DcmObject* next = sequence->nextInContainer(nullptr);
  while ((next = sequence->nextInContainer(next)) != nullptr) {
    auto* item = dynamic_cast<DcmPixelItem*>(next);
    Uint8* bytes = nullptr;
    if (item == nullptr || item->getUint8Array(bytes).bad() || bytes == nullptr) {
      return fail(cannotDecode(file, "a fragment is missing"));
    }
    const std::size_t length = item->getLength();
    const bool begins =
        length > 4 && ((bytes[0] == 0xFF && (bytes[1] == 0x4F || bytes[1] == 0xD8)) ||
                       (bytes[4] == 'j' && bytes[5] == 'P'));
    if (streams.empty() || oneEach || (frames > 1 && begins)) streams.emplace_back();
    streams.back().insert(streams.back().end(), bytes, bytes + length);
  }
  if (streams.size() != frames) {
    return fail(cannotDecode(file, "its code streams do not match its frames"));
  }
  return streams;
}

Result<DecodedFacts> decodeJpeg2000Frames(DcmPixelData& pixels, const DicomFile& file,
                                          const FrameSink& sink) {
  const auto streams = codeStreams(pixels, file);
  if (!streams) return fail(streams.error());
  DecodedFacts facts;
  const BitReader number(file);
  for (std::uint32_t f = 0; f < file.frames.size(); ++f) {
    auto image = decodeJpeg2000((*streams)[f], file.columns, file.rows);
    if (!image) return fail(cannotDecode(file, "its code stream is damaged"));
    facts.lossy = facts.lossy || !image->reversible;
    // The header says what the bits mean; some writers state another sign in the stream.
    for (std::int32_t& v : image->values) {
      v = number(static_cast<std::uint32_t>(v) << (file.highBit + 1 - file.bitsStored));
    }
    sink(f, image->values);
  }
  return facts;
}

/// Whether the code streams of JPEG, JPEG-LS and RLE are of the size that the header states.
Result<void> checkCodeStreams(DcmDataset& dataset, const DicomFile& file) {
  const PixelCoding coding = transferSyntaxOf(file.transferSyntax).coding;
  const bool rle = coding == PixelCoding::Rle;
  if (!rle && coding != PixelCoding::Jpeg && coding != PixelCoding::JpegLs) return {};
  DcmPixelData* pixels = pixelDataOf(dataset);
  if (pixels == nullptr) return fail(cannotDecode(file, "it holds no pixels"));
  const auto streams = codeStreams(*pixels, file);
  if (!streams) return fail(streams.error());
  for (const auto& stream : *streams) {
    if (rle ? rleIsOfSize(stream, file.bitsAllocated / 8, pixelsPerFrame(file))
            : jpegIsOfSize(stream, file.columns, file.rows)) {
      continue;
    }
    return fail(cannotDecode(file, "a code stream is damaged, or not of the stated " +
                                       std::to_string(file.columns) + " x " +
                                       std::to_string(file.rows) + " pixels"));
  }
  return {};
}

/// All bytes of the pixel data in native form, little-endian.
std::span<const std::uint8_t> nativeBytes(DcmDataset& dataset) {
  DcmElement* element = nullptr;
  if (dataset.findAndGetElement(DCM_PixelData, element).bad() || element == nullptr) return {};
  Uint16* words = nullptr;
  Uint8* bytes = nullptr;
  if (element->getUint16Array(words).good() && words != nullptr) {
    return {reinterpret_cast<const std::uint8_t*>(words), element->getLength()};
  }
  if (element->getUint8Array(bytes).good() && bytes != nullptr) {
    return {bytes, element->getLength()};
  }
  return {};
}

Result<DecodedFacts> decodeFrames(const DicomFile& file, const FrameVisitor& visit) {
  prepareDicomToolkit();
  DcmFileFormat format;
  const DicomParse parse = parseDicom(format, file.path);
  if (!parse.complete()) {
    return fail(cannotDecode(file, parse.limit.empty() ? kDamagedFile : parse.limit));
  }
  DcmDataset& dataset = *format.getDataset();
  FrameSink sink{visit, {}};
  if (file.modalityLut && !readLut(dataset, file, sink.lut)) {
    return fail(cannotDecode(file, "its modality table cannot be read"));
  }
  if (transferSyntaxOf(file.transferSyntax).coding == PixelCoding::Jpeg2000) {
    DcmPixelData* pixels = pixelDataOf(dataset);
    if (pixels == nullptr) return fail(cannotDecode(file, "it holds no pixels"));
    return decodeJpeg2000Frames(*pixels, file, sink);
  }
  if (auto sizes = checkCodeStreams(dataset, file); !sizes) return fail(sizes.error());
  if (file.bitsAllocated == 32 && dataset.getOriginalXfer() == EXS_BigEndianExplicit) {
    return fail(cannotDecode(file, "32-bit pixels in this byte order are not read"));
  }
  if (dataset.chooseRepresentation(EXS_LittleEndianExplicit, nullptr).bad() ||
      !dataset.canWriteXfer(EXS_LittleEndianExplicit)) {
    return fail(cannotDecode(file, "this compression is not read, or the image is damaged"));
  }
  const auto bytes = nativeBytes(dataset);
  const std::size_t frame = pixelsPerFrame(file);
  if (bytes.size() < bytesForPixels(file, frame * file.frames.size())) {
    return fail(cannotDecode(file, "it ends before its last pixel"));
  }
  std::vector<std::int32_t> values;
  for (std::uint32_t f = 0; f < file.frames.size(); ++f) {
    readCells(file, bytes.data(), f * frame, values);
    if (tooLarge(file, values)) {
      return fail(cannotDecode(file, "its values are larger than 31 bits"));
    }
    sink(f, values);
  }
  return DecodedFacts{};
}

}  // namespace

Result<DecodedFacts> decodeDicomFrames(const DicomFile& file, const FrameVisitor& visit) {
  if (!file.problem.empty()) return fail(cannotDecode(file, file.problem.reason));
  try {
    return decodeFrames(file, visit);
  } catch (const std::exception&) {
    // DCMTK throws at some damaged values; a damaged size may ask for more memory than there is.
    return fail(cannotDecode(file, kDamagedFile));
  }
}

}  // namespace palpate
