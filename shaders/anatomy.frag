#version 330 core
#include "lighting.glsl"
in vec3 eyePosition;
in vec3 eyeNormal;
out vec4 colour;
uniform vec3 baseColour;
void main() {
  vec3 toEye = normalize(-eyePosition);
  vec3 n = normalize(eyeNormal);
  vec3 base = fromSrgb(baseColour);
  if (dot(n, toEye) < -0.15) {
    // Seen from inside, through an opening: the same surface, darker.
    n = -n;
    base *= 0.55;
  }
  colour = vec4(toSrgb(lit(base, n, toEye, 0.10)), 1.0);
}
