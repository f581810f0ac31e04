// Light in camera space, sRGB in and out: a key from the upper left, a fill from the right, sky and
// ground ambience, a soft rim. n and toEye are unit vectors.
vec3 fromSrgb(vec3 c) { return pow(c, vec3(2.2)); }
vec3 toSrgb(vec3 c) { return pow(clamp(c, 0.0, 1.0), vec3(1.0 / 2.2)); }

vec3 lit(vec3 base, vec3 n, vec3 toEye, float gloss) {
  const vec3 key = vec3(-0.42, 0.60, 0.68);
  const vec3 fill = vec3(0.80, 0.10, 0.55);
  float k = max(dot(n, key), 0.0);
  float f = max(dot(n, fill), 0.0);
  float sky = 0.5 + 0.5 * n.y;
  vec3 ambient = mix(vec3(0.060, 0.055, 0.055), vec3(0.150, 0.160, 0.180), sky);
  vec3 light = ambient + k * vec3(0.80, 0.77, 0.72) + f * vec3(0.13, 0.16, 0.20);
  float rim = pow(1.0 - max(dot(n, toEye), 0.0), 3.0);
  vec3 h = normalize(key + toEye);
  float s = pow(max(dot(n, h), 0.0), 36.0) * gloss;
  return base * light + rim * vec3(0.045, 0.055, 0.065) * (0.35 + 0.65 * sky) + s * vec3(0.9);
}
