#version 330 core
#include "lighting.glsl"
in vec3 eyePosition;
in vec3 eyeNormal;
out vec4 colour;
uniform vec3 baseColour;
uniform float opacity;
void main() {
  vec3 base = fromSrgb(baseColour);
  vec3 n = normalize(eyeNormal);
  colour = vec4(toSrgb(mix(lit(base, n, normalize(-eyePosition), 0.2), base, 0.5)), opacity);
}
