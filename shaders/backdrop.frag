#version 330 core
in vec2 uv;
out vec4 colour;
uniform vec3 centreColour;
uniform vec3 edgeColour;
void main() {
  float d = length((uv - vec2(0.5, 0.56)) * vec2(1.0, 1.1));
  // Dithered by a fixed pattern, or the slow gradient shows bands.
  float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5;
  colour = vec4(mix(centreColour, edgeColour, smoothstep(0.0, 0.75, d)) + noise / 255.0, 1.0);
}
