#version 330 core
#include "lighting.glsl"
// Direct volume rendering: front to back, through a transfer function, skipping 8³ bricks that the
// function makes transparent. Writes the depth where the ray became half opaque, so that the
// instrument is hidden behind bone.
in vec2 uv;
out vec4 colour;
uniform sampler3D volume;       // normalised; times valueScale gives values
uniform sampler3D bricks;       // largest value of each brick and its rim, normalised
uniform sampler2D transfer;     // 256 × 1 over transferRange
uniform float valueScale;
uniform vec2 transferRange;
uniform float opaqueFrom;       // values below are transparent
uniform vec3 dims;
uniform vec3 brickCount;
uniform mat4 voxelFromClip;
uniform mat4 clipFromVoxel;
uniform mat3 eyeFromVoxelNormal;
uniform vec3 eyeVoxel;
uniform float stepVoxels;
uniform sampler2D backdrop;

float valueAt(vec3 v) { return texture(volume, (v + 0.5) / dims).r * valueScale; }

void main() {
  colour = texture(backdrop, uv);
  gl_FragDepth = 1.0;
  vec4 farPoint = voxelFromClip * vec4(uv * 2.0 - 1.0, 1.0, 1.0);
  vec3 d = normalize(farPoint.xyz / farPoint.w - eyeVoxel);
  vec3 inverse = 1.0 / (d + vec3(equal(d, vec3(0.0))) * 1e-9);
  vec3 t0 = (vec3(-0.5) - eyeVoxel) * inverse;
  vec3 t1 = (dims - 0.5 - eyeVoxel) * inverse;
  vec3 lo = min(t0, t1);
  vec3 hi = max(t0, t1);
  float t = max(0.0, max(lo.x, max(lo.y, lo.z)));
  float tEnd = min(hi.x, min(hi.y, hi.z));
  if (t >= tEnd) return;
  // A fixed pattern instead of noise hides the steps and keeps the picture the same every time.
  t += stepVoxels * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));

  vec3 sum = vec3(0.0);
  float opacity = 0.0;
  float firstHit = -1.0;
  for (int i = 0; i < 2048 && t < tEnd && opacity < 0.98; ++i) {
    vec3 p = eyeVoxel + d * t;
    vec3 brick = floor((p + 0.5) / 8.0);
    float most = texelFetch(bricks, ivec3(clamp(brick, vec3(0.0), brickCount - 1.0)), 0).r;
    if (most * valueScale < opaqueFrom) {
      vec3 side = (brick + step(vec3(0.0), d)) * 8.0 - 0.5;
      vec3 leave = (side - eyeVoxel) * inverse;
      t = max(t + 0.01, min(leave.x, min(leave.y, leave.z)) + 0.001);
      continue;
    }
    float value = valueAt(p);
    vec4 c = texture(transfer, vec2((value - transferRange.x) / (transferRange.y - transferRange.x), 0.5));
    // The table has 256 steps and its end is clamped: the limit itself is exact.
    if (value > opaqueFrom && c.a > 0.002) {
      vec3 g = vec3(valueAt(p + vec3(1, 0, 0)) - valueAt(p - vec3(1, 0, 0)),
                    valueAt(p + vec3(0, 1, 0)) - valueAt(p - vec3(0, 1, 0)),
                    valueAt(p + vec3(0, 0, 1)) - valueAt(p - vec3(0, 0, 1)));
      float steep = length(g);
      vec3 base = fromSrgb(c.rgb);
      vec3 n = steep > 1e-6 ? normalize(eyeFromVoxelNormal * (-g / steep)) : vec3(0, 0, 1);
      if (n.z < 0.0) n = -n;
      float a = 1.0 - pow(1.0 - c.a, stepVoxels);
      sum += (1.0 - opacity) * a * lit(base, n, vec3(0, 0, 1), 0.08);
      opacity += (1.0 - opacity) * a;
      if (firstHit < 0.0 && opacity > 0.5) firstHit = t;
    }
    t += stepVoxels;
  }
  colour = vec4(toSrgb(sum + (1.0 - opacity) * fromSrgb(colour.rgb)), 1.0);
  if (firstHit > 0.0) {
    vec4 clip = clipFromVoxel * vec4(eyeVoxel + d * firstHit, 1.0);
    gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;
  }
}
