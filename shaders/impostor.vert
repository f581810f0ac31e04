#version 330 core
// A contact as a quad that faces the eye; the fragment stage makes a sphere of it.
layout(location = 0) in vec4 centreRadius;  // mm, minus the scene's origin
layout(location = 1) in vec3 sphereColour;
uniform mat4 modelView;
uniform mat4 projection;
uniform float leastPixels;   // radius
uniform float mmPerPixelAtOne;
out vec3 eyeCentre;
out vec3 eyeCorner;
out vec3 tint;
flat out float radius;
void main() {
  vec2 corner = vec2((gl_VertexID & 1) == 0 ? -1.0 : 1.0, (gl_VertexID & 2) == 0 ? -1.0 : 1.0);
  eyeCentre = (modelView * vec4(centreRadius.xyz, 1.0)).xyz;
  radius = max(centreRadius.w, leastPixels * mmPerPixelAtOne * -eyeCentre.z);
  // 1.05: a sphere in perspective is a little wider than its radius.
  eyeCorner = eyeCentre + vec3(corner * radius * 1.05, 0.0);
  tint = sphereColour;
  gl_Position = projection * vec4(eyeCorner, 1.0);
}
