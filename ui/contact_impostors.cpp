#include "ui/contact_impostors.h"

#include <vector>

#include "core/geometry/units.h"
#include "ui/colours.h"
#include "ui/gl_api.h"

namespace palpate::ui {
namespace {

constexpr float kRadius_mm = 0.32F;      // about half a voxel of a head CT: contacts stay apart
constexpr float kLeastRadius_px = 3.0F;  // still a dot when the whole head is in view
constexpr float kTowardsEye_mm = 1.5F;   // contacts lie inside the bone; lift them onto its surface

}  // namespace

Result<ContactImpostors> ContactImpostors::load(const std::filesystem::path& shaders) {
  auto program = GlProgram::load(shaders, "impostor.vert", "impostor.frag");
  if (!program) return fail(program.error());
  ContactImpostors self;
  self.program_ = std::move(*program);
  unsigned array = 0;
  unsigned buffer = 0;
  glGenVertexArrays(1, &array);
  glGenBuffers(1, &buffer);
  self.array_ = GlVertexArray(array);
  self.instances_ = GlBuffer(buffer);
  glBindVertexArray(array);
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  constexpr int kStride = 7 * sizeof(float);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, kStride, nullptr);
  glVertexAttribDivisor(0, 1);
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, kStride,
                        reinterpret_cast<const void*>(4 * sizeof(float)));
  glVertexAttribDivisor(1, 1);
  glBindVertexArray(0);
  return self;
}

void ContactImpostors::update(const Snapshot& snapshot, const Eigen::Vector3d& origin_mm) {
  std::vector<float> data;
  data.reserve(std::size_t{snapshot.contactsDrawn} * 7);
  for (std::uint32_t i = 0; i < snapshot.contactsDrawn; ++i) {
    const Contact& contact = snapshot.contact_W[i];
    for (int c = 0; c < 3; ++c) {
      data.push_back(static_cast<float>(millimetres(contact.p[c]) - origin_mm[c]));
    }
    data.push_back(kRadius_mm);
    for (const float channel : contactColour(contact.depth)) data.push_back(channel);
  }
  count_ = static_cast<int>(snapshot.contactsDrawn);
  glBindBuffer(GL_ARRAY_BUFFER, instances_.id());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(data.size() * sizeof(float)), data.data(),
               GL_STREAM_DRAW);
}

void ContactImpostors::draw(const Camera& camera, const Eigen::Vector3d& origin_mm, double aspect,
                            double heightPixels) const {
  if (count_ == 0) return;
  program_.use();
  program_.set("modelView", camera.view(origin_mm));
  program_.set("projection", camera.projection(aspect));
  program_.set("leastPixels", kLeastRadius_px * static_cast<float>(heightPixels / 700.0));
  program_.set("mmPerPixelAtOne",
               static_cast<float>(camera.millimetresPerPixel(heightPixels) / camera.distance_mm));
  program_.set("towardsEye", kTowardsEye_mm);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glBindVertexArray(array_.id());
  glDepthMask(GL_FALSE);
  glDepthFunc(GL_GREATER);
  program_.set("opacity", 0.60F);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count_);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LESS);
  program_.set("opacity", 1.0F);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count_);
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
}

}  // namespace palpate::ui
