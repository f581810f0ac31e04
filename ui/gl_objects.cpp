#include "ui/gl_objects.h"

#include <fstream>
#include <sstream>

#include "ui/gl_api.h"

namespace palpate::ui {
namespace {

Result<std::string> readStage(const std::filesystem::path& folder, const std::string& name) {
  std::ifstream in(folder / name);
  if (!in) {
    return fail(machineError("A shader file is missing, so nothing can be drawn.")
                    .inFile((folder / name).string())
                    .advise("Reinstall Palpate, or give the folder with --shaders."));
  }
  std::string text;
  std::string line;
  const std::string word = "#include \"";
  while (std::getline(in, line)) {
    if (line.rfind(word, 0) == 0) {
      auto part = readStage(folder, line.substr(word.size(), line.rfind('"') - word.size()));
      if (!part) return part;
      text += *part;
    } else {
      text += line + '\n';
    }
  }
  return text;
}

Result<unsigned> compileStage(unsigned kind, const std::string& name, const std::string& text) {
  const unsigned id = glCreateShader(kind);
  const char* source = text.c_str();
  glShaderSource(id, 1, &source, nullptr);
  glCompileShader(id);
  int ok = 0;
  glGetShaderiv(id, GL_COMPILE_STATUS, &ok);
  if (ok != 0) return id;
  std::string log(2048, '\0');
  int length = 0;
  glGetShaderInfoLog(id, static_cast<int>(log.size()), &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  glDeleteShader(id);
  return fail(machineError("The graphics driver does not accept a shader.")
                  .inFile(name)
                  .butFound(log)
                  .advise("Update the graphics driver, or set LIBGL_ALWAYS_SOFTWARE=1."));
}

}  // namespace

GlTexture makeTexture2D(int width, int height, int internal, unsigned format, unsigned type,
                        int filter) {
  unsigned id = 0;
  glGenTextures(1, &id);
  glBindTexture(GL_TEXTURE_2D, id);
  glTexImage2D(GL_TEXTURE_2D, 0, internal, width, height, 0, format, type, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return GlTexture(id);
}

void freeProgram(unsigned id) {
  glDeleteProgram(id);
}
void freeTexture(unsigned id) {
  glDeleteTextures(1, &id);
}
void freeBuffer(unsigned id) {
  glDeleteBuffers(1, &id);
}
void freeVertexArray(unsigned id) {
  glDeleteVertexArrays(1, &id);
}
void freeFramebuffer(unsigned id) {
  glDeleteFramebuffers(1, &id);
}

Result<GlProgram> GlProgram::load(const std::filesystem::path& folder, const std::string& vertex,
                                  const std::string& fragment) {
  const auto vertexText = readStage(folder, vertex);
  if (!vertexText) return fail(vertexText.error());
  const auto fragmentText = readStage(folder, fragment);
  if (!fragmentText) return fail(fragmentText.error());
  const auto v = compileStage(GL_VERTEX_SHADER, vertex, *vertexText);
  if (!v) return fail(v.error());
  const auto f = compileStage(GL_FRAGMENT_SHADER, fragment, *fragmentText);
  if (!f) return fail(f.error());
  GlProgram program;
  program.id_ = GlHandle<freeProgram>(glCreateProgram());
  glAttachShader(program.id_.id(), *v);
  glAttachShader(program.id_.id(), *f);
  glLinkProgram(program.id_.id());
  glDeleteShader(*v);
  glDeleteShader(*f);
  int ok = 0;
  glGetProgramiv(program.id_.id(), GL_LINK_STATUS, &ok);
  if (ok == 0) {
    return fail(machineError("The graphics driver does not link a shader program.")
                    .inFile(vertex + " + " + fragment)
                    .advise("Update the graphics driver, or set LIBGL_ALWAYS_SOFTWARE=1."));
  }
  return program;
}

void GlProgram::use() const {
  glUseProgram(id_.id());
}
int GlProgram::location(const char* name) const {
  return glGetUniformLocation(id_.id(), name);
}
void GlProgram::set(const char* name, int value) const {
  glUniform1i(location(name), value);
}
void GlProgram::set(const char* name, float value) const {
  glUniform1f(location(name), value);
}
void GlProgram::set(const char* name, const Eigen::Vector2f& v) const {
  glUniform2fv(location(name), 1, v.data());
}
void GlProgram::set(const char* name, const Eigen::Vector3f& v) const {
  glUniform3fv(location(name), 1, v.data());
}
void GlProgram::set(const char* name, const Eigen::Vector4f& v) const {
  glUniform4fv(location(name), 1, v.data());
}
void GlProgram::set(const char* name, const Eigen::Matrix3f& m) const {
  glUniformMatrix3fv(location(name), 1, GL_FALSE, m.data());
}
void GlProgram::set(const char* name, const Eigen::Matrix4f& m) const {
  glUniformMatrix4fv(location(name), 1, GL_FALSE, m.data());
}
void GlProgram::texture(const char* name, int unit, unsigned target, unsigned id) const {
  glActiveTexture(GL_TEXTURE0 + static_cast<unsigned>(unit));
  glBindTexture(target, id);
  set(name, unit);
}

bool GlFramebuffer::resize(int width, int height) {
  if (width == width_ && height == height_) return false;
  width_ = width;
  height_ = height;
  colour_ = makeTexture2D(width, height, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, GL_LINEAR);
  depth_ = makeTexture2D(width, height, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT,
                         GL_NEAREST);
  if (!id_) {
    unsigned id = 0;
    glGenFramebuffers(1, &id);
    id_ = GlHandle<freeFramebuffer>(id);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, id_.id());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colour_.id(), 0);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth_.id(), 0);
  return true;
}

void GlFramebuffer::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, id_.id());
  glViewport(0, 0, width_, height_);
}

void GlFramebuffer::copyFrom(const GlFramebuffer& other) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, other.id_.id());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, id_.id());
  glBlitFramebuffer(0, 0, other.width_, other.height_, 0, 0, width_, height_, GL_DEPTH_BUFFER_BIT,
                    GL_NEAREST);
  const bool same = other.width_ == width_ && other.height_ == height_;
  glBlitFramebuffer(0, 0, other.width_, other.height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT,
                    same ? GL_NEAREST : GL_LINEAR);
}

void bindWindow(int width, int height) {
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, width, height);
}

std::vector<std::uint8_t> readWindowPixels(int width, int height) {
  const auto row = static_cast<std::size_t>(width) * 4;
  std::vector<std::uint8_t> bottomUp(row * static_cast<std::size_t>(height));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, bottomUp.data());
  std::vector<std::uint8_t> topDown;
  topDown.reserve(bottomUp.size());
  for (std::size_t y = static_cast<std::size_t>(height); y-- > 0;) {
    const auto begin = bottomUp.begin() + static_cast<std::ptrdiff_t>(y * row);
    topDown.insert(topDown.end(), begin, begin + static_cast<std::ptrdiff_t>(row));
  }
  for (std::size_t i = 3; i < topDown.size(); i += 4) topDown[i] = 255;
  return topDown;
}

void drawFullScreen() {
  static unsigned array = 0;  // Core profile wants one bound; it holds nothing.
  if (array == 0) glGenVertexArrays(1, &array);
  glBindVertexArray(array);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

GlMesh makeMesh(const std::vector<float>& interleaved,
                const std::vector<std::uint32_t>& triangles) {
  GlMesh mesh;
  unsigned ids[2] = {0, 0};
  unsigned array = 0;
  glGenVertexArrays(1, &array);
  glGenBuffers(2, ids);
  mesh.array = GlVertexArray(array);
  mesh.vertices = GlBuffer(ids[0]);
  mesh.indices = GlBuffer(ids[1]);
  mesh.indexCount = static_cast<int>(triangles.size());
  glBindVertexArray(array);
  glBindBuffer(GL_ARRAY_BUFFER, ids[0]);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(interleaved.size() * sizeof(float)),
               interleaved.data(), GL_STATIC_DRAW);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, ids[1]);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(triangles.size() * 4),
               triangles.data(), GL_STATIC_DRAW);
  constexpr int kStride = 6 * sizeof(float);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, kStride, nullptr);
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, kStride,
                        reinterpret_cast<const void*>(3 * sizeof(float)));
  glBindVertexArray(0);
  return mesh;
}

void drawMesh(const GlMesh& mesh) {
  glBindVertexArray(mesh.array.id());
  glDrawElements(GL_TRIANGLES, mesh.indexCount, GL_UNSIGNED_INT, nullptr);
}

}  // namespace palpate::ui
