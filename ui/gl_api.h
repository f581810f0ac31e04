#pragma once
/// OpenGL 4.5 core, exported by libOpenGL itself: no loader. For sources of ui/ only.

#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>
