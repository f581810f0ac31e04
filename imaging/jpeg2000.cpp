#include "imaging/jpeg2000.h"

#include <openjpeg.h>

#include <algorithm>
#include <cstring>
#include <memory>

namespace palpate {
namespace {

struct Source {
  std::span<const std::uint8_t> bytes;
  std::size_t at = 0;
};

constexpr auto kEnd = static_cast<OPJ_SIZE_T>(-1);

OPJ_SIZE_T readSome(void* buffer, OPJ_SIZE_T count, void* user) {
  auto& source = *static_cast<Source*>(user);
  const std::size_t got = std::min<std::size_t>(count, source.bytes.size() - source.at);
  if (got == 0) return kEnd;
  std::memcpy(buffer, source.bytes.data() + source.at, got);
  source.at += got;
  return got;
}

OPJ_OFF_T skipSome(OPJ_OFF_T count, void* user) {
  auto& source = *static_cast<Source*>(user);
  if (count < 0) return -1;
  const std::size_t left = source.bytes.size() - source.at;
  const std::size_t skipped = std::min(static_cast<std::size_t>(count), left);
  source.at += skipped;
  return skipped == 0 && count > 0 ? -1 : static_cast<OPJ_OFF_T>(skipped);
}

OPJ_BOOL seekTo(OPJ_OFF_T position, void* user) {
  auto& source = *static_cast<Source*>(user);
  if (position < 0 || static_cast<std::size_t>(position) > source.bytes.size()) return OPJ_FALSE;
  source.at = static_cast<std::size_t>(position);
  return OPJ_TRUE;
}

struct FreeStream {
  void operator()(opj_stream_t* s) const noexcept { opj_stream_destroy(s); }
};
struct FreeCodec {
  void operator()(opj_codec_t* c) const noexcept { opj_destroy_codec(c); }
};
struct FreeImage {
  void operator()(opj_image_t* i) const noexcept { opj_image_destroy(i); }
};

bool isReversible(opj_codec_t* codec) {
  opj_codestream_info_v2_t* info = opj_get_cstr_info(codec);
  if (info == nullptr) return false;
  const bool reversible = info->m_default_tile_info.tccp_info != nullptr &&
                          info->m_default_tile_info.tccp_info[0].qmfbid == 1;
  opj_destroy_cstr_info(&info);
  return reversible;
}

}  // namespace

std::optional<Jpeg2000Image> decodeJpeg2000(std::span<const std::uint8_t> bytes,
                                            std::uint32_t columns, std::uint32_t rows) {
  if (bytes.size() < 12) return std::nullopt;
  const bool boxed = bytes[4] == 'j' && bytes[5] == 'P';  // JP2 file instead of a bare stream
  Source source{bytes, 0};
  std::unique_ptr<opj_stream_t, FreeStream> stream(opj_stream_create(1U << 16U, OPJ_TRUE));
  std::unique_ptr<opj_codec_t, FreeCodec> codec(
      opj_create_decompress(boxed ? OPJ_CODEC_JP2 : OPJ_CODEC_J2K));
  if (!stream || !codec) return std::nullopt;
  opj_stream_set_user_data(stream.get(), &source, nullptr);
  opj_stream_set_user_data_length(stream.get(), bytes.size());
  opj_stream_set_read_function(stream.get(), readSome);
  opj_stream_set_skip_function(stream.get(), skipSome);
  opj_stream_set_seek_function(stream.get(), seekTo);
  opj_dparameters_t parameters;
  opj_set_default_decoder_parameters(&parameters);
  if (opj_setup_decoder(codec.get(), &parameters) == OPJ_FALSE) return std::nullopt;
  opj_decoder_set_strict_mode(codec.get(), OPJ_TRUE);  // a short stream is a damaged one
  opj_image_t* raw = nullptr;
  const bool header = opj_read_header(stream.get(), codec.get(), &raw) == OPJ_TRUE;
  std::unique_ptr<opj_image_t, FreeImage> image(raw);
  if (!header || !image || image->numcomps != 1 || image->comps[0].w != columns ||
      image->comps[0].h != rows || image->comps[0].prec > 31) {
    return std::nullopt;
  }
  Jpeg2000Image out;
  out.reversible = isReversible(codec.get());
  if (opj_decode(codec.get(), stream.get(), image.get()) == OPJ_FALSE ||
      opj_end_decompress(codec.get(), stream.get()) == OPJ_FALSE ||
      image->comps[0].data == nullptr) {
    return std::nullopt;
  }
  const opj_image_comp_t& component = image->comps[0];
  out.columns = component.w;
  out.rows = component.h;
  out.bits = component.prec;
  out.isSigned = component.sgnd != 0;
  out.values.assign(component.data,
                    component.data + static_cast<std::size_t>(component.w) * component.h);
  return out;
}

}  // namespace palpate
