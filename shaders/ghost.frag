#version 330 core
// A body that is not there: rim only, in one colour.
in vec3 eyePosition;
in vec3 eyeNormal;
out vec4 colour;
uniform vec3 baseColour;
uniform float opacity;
void main() {
  float facing = abs(dot(normalize(eyeNormal), normalize(-eyePosition)));
  colour = vec4(baseColour, opacity * (0.08 + 0.92 * pow(1.0 - facing, 2.2)));
}
