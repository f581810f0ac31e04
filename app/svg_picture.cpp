#include "app/svg_picture.h"

#include <cairo.h>
#include <librsvg/rsvg.h>

#include <cmath>
#include <memory>

namespace palpate {
namespace {

Error notDrawn(const std::string& why) {
  return machineError("The picture could not be drawn: " + why + ".");
}

cairo_status_t append(void* to, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

Result<std::string> pngOfSvg(const std::string& svg) {
  constexpr double kScale = 2.0;
  GError* problem = nullptr;
  const std::unique_ptr<RsvgHandle, void (*)(RsvgHandle*)> handle(
      rsvg_handle_new_from_data(reinterpret_cast<const guint8*>(svg.data()), svg.size(), &problem),
      [](RsvgHandle* h) {
        if (h != nullptr) g_object_unref(h);
      });
  if (!handle) {
    Error error = notDrawn(problem != nullptr ? problem->message : "not SVG");
    g_clear_error(&problem);
    return fail(std::move(error));
  }
  gdouble width = 0.0, height = 0.0;
  if (!rsvg_handle_get_intrinsic_size_in_pixels(handle.get(), &width, &height)) {
    return fail(notDrawn("it has no size"));
  }
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_ARGB32, static_cast<int>(std::ceil(kScale * width)),
                                 static_cast<int>(std::ceil(kScale * height))),
      cairo_surface_destroy);
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> context(cairo_create(surface.get()),
                                                             cairo_destroy);
  const RsvgRectangle whole{0.0, 0.0, kScale * width, kScale * height};
  if (!rsvg_handle_render_document(handle.get(), context.get(), &whole, &problem)) {
    Error error = notDrawn(problem != nullptr ? problem->message : "unknown reason");
    g_clear_error(&problem);
    return fail(std::move(error));
  }
  std::string png;
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface.get(), append, &png);
  if (status != CAIRO_STATUS_SUCCESS) return fail(notDrawn(cairo_status_to_string(status)));
  return png;
}

}  // namespace palpate
