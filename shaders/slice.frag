#version 330 core
// One slice: grey values through window/level, labels on top, the threshold's preview.
in vec2 uv;
out vec4 colour;
uniform sampler3D volume;       // normalised; times valueScale gives values
uniform usampler3D labels;
uniform sampler2D palette;      // 256 × 1: label colour, alpha 0 = hidden
uniform bool hasLabels;
uniform float valueScale;
uniform vec2 windowRange;       // low, high
uniform vec2 preview;           // threshold; low > high: none
uniform vec3 previewColour;
uniform float labelOpacity;
uniform float edgeOpacity;      // of a label's outline; 0: none
uniform vec2 viewSize;          // pixels
uniform vec3 voxelOrigin;       // continuous voxel index at the view's top left corner
uniform vec3 voxelRight;        // per pixel
uniform vec3 voxelDown;
uniform vec3 dims;

uint labelAt(vec3 voxel) {
  ivec3 at = clamp(ivec3(floor(voxel + 0.5)), ivec3(0), ivec3(dims) - 1);
  return texelFetch(labels, at, 0).r;
}

void main() {
  // The picture is stored top row first: row 0 of the texture is the top of the view.
  vec2 pixel = uv * viewSize;
  vec3 voxel = voxelOrigin + voxelRight * pixel.x + voxelDown * pixel.y;
  if (any(lessThan(voxel, vec3(-0.5))) || any(greaterThanEqual(voxel, dims - 0.5))) {
    colour = vec4(0.0, 0.0, 0.0, 1.0);
    return;
  }
  float value = texture(volume, (voxel + 0.5) / dims).r * valueScale;
  float grey = clamp((value - windowRange.x) / max(1e-6, windowRange.y - windowRange.x), 0.0, 1.0);
  vec3 c = vec3(grey);
  if (hasLabels) {
    uint label = texelFetch(labels, ivec3(floor(voxel + 0.5)), 0).r;
    vec4 tint = texelFetch(palette, ivec2(int(label), 0), 0);
    // A label's edge, one pixel wide, is drawn plainly: bone on bright bone is hard to see.
    bool edge = label != 0u && (labelAt(voxel + voxelRight) != label ||
                                labelAt(voxel - voxelRight) != label ||
                                labelAt(voxel + voxelDown) != label ||
                                labelAt(voxel - voxelDown) != label);
    float opacity = edge ? max(edgeOpacity, labelOpacity) : labelOpacity;
    c = mix(c, tint.rgb, label == 0u ? 0.0 : tint.a * opacity);
  }
  if (preview.x <= preview.y && value >= preview.x && value <= preview.y) {
    c = mix(c, previewColour, 0.5);
  }
  colour = vec4(c, 1.0);
}
