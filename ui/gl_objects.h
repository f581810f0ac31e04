#pragma once
/// OpenGL objects that free themselves: programs from shaders/, textures, framebuffers, buffers.
///
/// Every function needs the window's context current on the calling thread (the main thread).

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"

namespace palpate::ui {

/// A handle that is deleted once. `Free` takes the number.
template <void (*Free)(unsigned)>
class GlHandle {
 public:
  GlHandle() = default;
  explicit GlHandle(unsigned id) noexcept : id_(id) {}
  GlHandle(GlHandle&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  GlHandle& operator=(GlHandle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~GlHandle() {
    if (id_ != 0) Free(id_);
  }
  [[nodiscard]] unsigned id() const noexcept { return id_; }
  explicit operator bool() const noexcept { return id_ != 0; }

 private:
  unsigned id_ = 0;
};

void freeProgram(unsigned id);
void freeTexture(unsigned id);
void freeBuffer(unsigned id);
void freeVertexArray(unsigned id);
void freeFramebuffer(unsigned id);

using GlTexture = GlHandle<freeTexture>;
using GlBuffer = GlHandle<freeBuffer>;
using GlVertexArray = GlHandle<freeVertexArray>;

/// Without content; `filter` both ways, clamped at the edge.
[[nodiscard]] GlTexture makeTexture2D(int width, int height, int internal, unsigned format,
                                      unsigned type, int filter);

/// A linked vertex + fragment program. Uniforms by name; unknown names are ignored (the compiler
/// may have removed them).
class GlProgram {
 public:
  GlProgram() = default;
  /// Reads `vertex` and `fragment` from `folder`; a line `#include "x.glsl"` is replaced by that
  /// file. Refuses a missing file and a stage the driver does not compile, with its message.
  [[nodiscard]] static Result<GlProgram> load(const std::filesystem::path& folder,
                                              const std::string& vertex,
                                              const std::string& fragment);
  void use() const;
  void set(const char* name, int value) const;
  void set(const char* name, float value) const;
  void set(const char* name, const Eigen::Vector2f& value) const;
  void set(const char* name, const Eigen::Vector3f& value) const;
  void set(const char* name, const Eigen::Vector4f& value) const;
  void set(const char* name, const Eigen::Matrix3f& value) const;
  void set(const char* name, const Eigen::Matrix4f& value) const;
  /// Binds a texture to a unit and the sampler to that unit.
  void texture(const char* name, int unit, unsigned target, unsigned id) const;

 private:
  [[nodiscard]] int location(const char* name) const;
  GlHandle<freeProgram> id_;
};

/// Colour (RGBA8, linear filter) and depth (24 bit) as textures of one size.
class GlFramebuffer {
 public:
  /// Keeps the old storage when the size is unchanged. Returns true if it was made anew.
  bool resize(int width, int height);
  void bind() const;  ///< And sets the viewport to all of it.
  [[nodiscard]] unsigned colour() const noexcept { return colour_.id(); }
  [[nodiscard]] unsigned depth() const noexcept { return depth_.id(); }
  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  /// Copies colour and depth; a framebuffer of another size is scaled.
  void copyFrom(const GlFramebuffer& other) const;

 private:
  GlHandle<freeFramebuffer> id_;
  GlTexture colour_, depth_;
  int width_ = 0, height_ = 0;
};

/// The framebuffer of the window, whole.
void bindWindow(int width, int height);
/// RGBA, top row first.
[[nodiscard]] std::vector<std::uint8_t> readWindowPixels(int width, int height);
/// Three vertices without buffers, for full-screen passes.
void drawFullScreen();

struct GlMesh {
  GlVertexArray array;
  GlBuffer vertices, indices;
  int indexCount = 0;
};
/// Interleaved position and normal (6 floats a vertex; attributes 0 and 1).
[[nodiscard]] GlMesh makeMesh(const std::vector<float>& interleaved,
                              const std::vector<std::uint32_t>& triangles);
void drawMesh(const GlMesh& mesh);

}  // namespace palpate::ui
