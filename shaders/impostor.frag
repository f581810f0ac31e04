#version 330 core
#include "lighting.glsl"
in vec3 eyeCentre;
in vec3 eyeCorner;
in vec3 tint;
flat in float radius;
out vec4 colour;
uniform mat4 projection;
uniform float opacity;
uniform float towardsEye;  // mm the depth is moved, so that a contact shows on its surface
void main() {
  // Ray from the eye through this corner against the sphere.
  vec3 d = normalize(eyeCorner);
  float b = dot(d, eyeCentre);
  float h = b * b - dot(eyeCentre, eyeCentre) + radius * radius;
  if (h < 0.0) discard;
  vec3 p = d * (b - sqrt(h));
  vec3 n = (p - eyeCentre) / radius;
  vec4 clip = projection * vec4(p * (1.0 - towardsEye / max(1.0, length(p))), 1.0);
  gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;
  vec3 base = fromSrgb(tint);
  colour = vec4(toSrgb(mix(lit(base, n, -d, 0.15), base, 0.45)), opacity);
}
