#version 330 core
// Darkens the anatomy in its hollows: twelve depth taps around each pixel, at a radius that is the
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
  // A fixed rotation per pixel of a 4×4 pattern: no noise texture, the same picture every time.
  float turn = float((int(gl_FragCoord.x) & 3) * 4 + (int(gl_FragCoord.y) & 3)) * 0.3927;
  for (int i = 0; i < 12; ++i) {
    float angle = turn + float(i) * 2.399963;
    float r = reach * sqrt((float(i) + 0.5) / 12.0);
    float there = distanceAt(texture(depthMap, uv + vec2(cos(angle), sin(angle)) * r / size).r);
    float closer = here - there;
    // Far in front is another surface, not a hollow: fade its share out.
    hidden += smoothstep(0.02 * radius, 0.6 * radius, closer) *
              (1.0 - smoothstep(1.5 * radius, 4.0 * radius, closer));
  }
  colour.rgb *= 1.0 - 0.62 * hidden / 12.0;
}
