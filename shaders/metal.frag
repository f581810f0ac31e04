#version 330 core
#include "lighting.glsl"
// Brushed steel: a procedural studio (soft boxes and a dark floor) in the reflection.
in vec3 eyePosition;
in vec3 eyeNormal;
out vec4 colour;
uniform vec3 baseColour;

vec3 studio(vec3 r) {
  float up = 0.5 + 0.5 * r.y;
  vec3 c = mix(vec3(0.05, 0.055, 0.06), vec3(0.32, 0.34, 0.37), smoothstep(0.25, 0.9, up));
  c += vec3(1.10, 1.06, 1.00) * smoothstep(0.62, 0.86, dot(r, normalize(vec3(-0.55, 0.62, 0.56))));
  c += vec3(0.42, 0.48, 0.55) * smoothstep(0.70, 0.95, dot(r, normalize(vec3(0.85, 0.05, 0.50))));
  return c;
}

void main() {
  vec3 toEye = normalize(-eyePosition);
  vec3 n = normalize(eyeNormal);
  if (dot(n, toEye) < 0.0) n = -n;
  vec3 base = fromSrgb(baseColour);
  float facing = max(dot(n, toEye), 0.0);
  float fresnel = pow(1.0 - facing, 5.0);
  vec3 reflected = studio(reflect(-toEye, n));
  vec3 c = base * reflected * 1.05 + fresnel * vec3(0.45) + lit(base * 0.30, n, toEye, 0.35);
  colour = vec4(toSrgb(c), 1.0);
}
