#version 330 core
// Darkens the anatomy in its hollows: six pairs of depth taps around each pixel, at a radius that is the
// same in the patient (mm) wherever it is seen. Also hands the depth on.
in vec2 uv;
out vec4 colour;
uniform sampler2D colourMap;
uniform sampler2D depthMap;
uniform vec2 planes;        // near, far; mm
uniform float radius;       // mm
uniform float pixelsPerMm;  // at 1 mm from the eye: divide by the distance
uniform bool enabled;

float distanceAt(float d) {
  float z = d * 2.0 - 1.0;
  return 2.0 * planes.x * planes.y / (planes.y + planes.x - z * (planes.y - planes.x));
}

void main() {
  float depth = texture(depthMap, uv).r;
  gl_FragDepth = depth;
  colour = texture(colourMap, uv);
  if (!enabled || depth >= 1.0) return;
  vec2 size = vec2(textureSize(depthMap, 0));
  float here = distanceAt(depth);
  float reach = clamp(radius * pixelsPerMm / here, 2.0, 60.0);
  float hidden = 0.0;
  // A fixed rotation per pixel of a 2×2 block, which the half-size picture then averages: no noise.
  float turn = float((int(gl_FragCoord.x) & 1) * 2 + (int(gl_FragCoord.y) & 1)) * 0.65;
  for (int i = 0; i < 6; ++i) {
    // Opposite taps in pairs: on a slope one is nearer by what the other is farther, so that only
    // hollows darken.
    float angle = turn + float(i) * 2.399963;
    vec2 offset = vec2(cos(angle), sin(angle)) * reach * sqrt((float(i) + 0.5) / 6.0) / size;
    float a = here - distanceAt(texture(depthMap, uv + offset).r);
    float b = here - distanceAt(texture(depthMap, uv - offset).r);
    // Far in front or behind is another surface: it says nothing about this one.
    float share = (1.0 - smoothstep(2.0 * radius, 5.0 * radius, abs(a))) *
                 (1.0 - smoothstep(2.0 * radius, 5.0 * radius, abs(b)));
    hidden += share * smoothstep(0.02 * radius, 0.55 * radius, 0.5 * (a + b));
  }
  colour.rgb *= 1.0 - 0.60 * hidden / 6.0;
}
