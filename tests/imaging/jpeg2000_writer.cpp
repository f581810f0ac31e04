#include "tests/imaging/jpeg2000_writer.h"

#include <openjpeg.h>

#include <memory>
#include <stdexcept>

namespace palpate::test {
namespace {

struct Sink {
  std::string bytes;
  std::size_t at = 0;
};

OPJ_SIZE_T writeSome(void* buffer, OPJ_SIZE_T count, void* user) {
  Sink& sink = *static_cast<Sink*>(user);
  if (sink.bytes.size() < sink.at + count) sink.bytes.resize(sink.at + count);
  sink.bytes.replace(sink.at, count, static_cast<const char*>(buffer), count);
  sink.at += count;
  return count;
}

OPJ_BOOL seekTo(OPJ_OFF_T position, void* user) {
  static_cast<Sink*>(user)->at = static_cast<std::size_t>(position);
  return OPJ_TRUE;
}

OPJ_OFF_T skipSome(OPJ_OFF_T count, void* user) {
  static_cast<Sink*>(user)->at += static_cast<std::size_t>(count);
  return count;
}

}  // namespace

std::string encodeJpeg2000(std::uint32_t columns, std::uint32_t rows) {
  opj_image_cmptparm_t component{};
  component.dx = component.dy = 1;
  component.w = columns;
  component.h = rows;
  component.prec = 16;
  const std::unique_ptr<opj_image_t, void (*)(opj_image_t*)> image(
      opj_image_create(1, &component, OPJ_CLRSPC_GRAY), opj_image_destroy);
  if (!image) throw std::runtime_error("no JPEG 2000 image");
  image->x1 = columns;
  image->y1 = rows;
  for (std::uint32_t i = 0; i < columns * rows; ++i) {
    image->comps[0].data[i] = static_cast<OPJ_INT32>(i * 37 % 4096);
  }
  opj_cparameters_t parameters;
  opj_set_default_encoder_parameters(&parameters);
  parameters.numresolution = 3;
  parameters.tcp_numlayers = 1;
  parameters.cp_disto_alloc = 1;
  const std::unique_ptr<opj_codec_t, void (*)(opj_codec_t*)> codec(
      opj_create_compress(OPJ_CODEC_J2K), opj_destroy_codec);
  const std::unique_ptr<opj_stream_t, void (*)(opj_stream_t*)> stream(
      opj_stream_create(1U << 16U, OPJ_FALSE), opj_stream_destroy);
  Sink sink;
  opj_stream_set_user_data(stream.get(), &sink, nullptr);
  opj_stream_set_write_function(stream.get(), writeSome);
  opj_stream_set_seek_function(stream.get(), seekTo);
  opj_stream_set_skip_function(stream.get(), skipSome);
  if (opj_setup_encoder(codec.get(), &parameters, image.get()) == OPJ_FALSE ||
      opj_start_compress(codec.get(), image.get(), stream.get()) == OPJ_FALSE ||
      opj_encode(codec.get(), stream.get()) == OPJ_FALSE ||
      opj_end_compress(codec.get(), stream.get()) == OPJ_FALSE) {
    throw std::runtime_error("no JPEG 2000 stream");
  }
  return sink.bytes;
}

}  // namespace palpate::test
