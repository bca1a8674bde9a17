// From what is where to a picture: a lamp, a sky that narrow gaps see less of, inked edges.
uniform sampler2D surface;
uniform sampler2D number;
uniform sampler2D depth;
uniform sampler2D colours; // by number of the body, 256 a row
uniform vec2 tangents;     // of half the angles of view
uniform vec2 range;        // nearest and farthest depth
uniform mat3 axes;         // right, up and towards the eye, in the drawing
uniform vec3 lamp;         // on these axes
uniform vec3 paper;
uniform vec3 accent;
uniform float solidity;    // 1 solid, less is see-through
uniform float crease;      // strength of the lines between faces
uniform float gap;         // how far neighbours dim each other
uniform float gapPixels;   // the same in pixels, at the centre of the drawing's depth
uniform int samples;       // of the gaps; 0 for none
uniform uint chosen;       // number of the body that was clicked, from 1

out vec4 colour;

const float SECTION = 0.75;

ivec2 extent;

ivec2 within(ivec2 p) { return clamp(p, ivec2(0), extent - 1); }

float kindAt(ivec2 p) { return texelFetch(surface, within(p), 0).a; }

vec3 normalAt(ivec2 p) { return normalize(texelFetch(surface, within(p), 0).xyz * 2.0 - 1.0); }

uint bodyAt(ivec2 p) {
  uvec3 bytes = uvec3(texelFetch(number, within(p), 0).rgb * 255.0 + 0.5);
  return bytes.r | bytes.g << 8 | bytes.b << 16;
}

// The point that is seen, on the eye's axes.
vec3 pointAt(ivec2 p) {
  float shown = texelFetch(depth, p, 0).r;
  float far = range.x * range.y / (range.y - shown * (range.y - range.x));
  vec2 screen = (vec2(p) + 0.5) / vec2(extent) * 2.0 - 1.0;
  return vec3(screen * tangents * far, -far);
}

// Share of the sky that a point sees (after McGuire et al. 2011).
float openness(ivec2 here, vec3 point, vec3 normal) {
  if (samples == 0) return 1.0;
  // The samples of neighbouring pixels are turned against each other, so that no bands are left.
  float turn = 6.28318531 * fract(52.9829189 * fract(dot(vec2(here), vec2(0.06711056, 0.00583715))));
  float blocked = 0.0;
  for (int k = 0; k < samples; k++) {
    float radius = gapPixels * sqrt((float(k) + 0.5) / float(samples));
    float angle = 2.39996323 * float(k) + turn;
    vec3 way = pointAt(within(here + ivec2(radius * vec2(cos(angle), sin(angle))))) - point;
    float far2 = dot(way, way);
    if (far2 > 0.0 && far2 < gap * gap) {
      blocked += max(dot(normal, way) * inversesqrt(far2) - 0.08, 0.0) * (1.0 - far2 / (gap * gap));
    }
  }
  return clamp(1.0 - 4.0 * blocked / float(samples), 0.0, 1.0);
}

// What the lines leave of the light; the borders of the chosen body have its colour.
float ink(ivec2 here, uint body, float kind, vec3 normal) {
  float left = 1.0;
  for (int k = 0; k < 4; k++) {
    ivec2 there = here + ivec2[4](ivec2(1, 0), ivec2(0, 1), ivec2(-1, 0), ivec2(0, -1))[k];
    if (bodyAt(there) != body) return mix(1.0, 0.25, 0.35 + 0.65 * crease);
    bool edge = kindAt(there) != kind || dot(normalAt(there), normal) < 0.978;
    // Each edge is drawn on one side of it only.
    if (k < 2 && edge) left = mix(1.0, 0.6, crease);
  }
  return left;
}

bool nearChosen(ivec2 here) {
  for (int k = 0; k < 8; k++) {
    ivec2 way = ivec2[8](ivec2(2, 0), ivec2(-2, 0), ivec2(0, 2), ivec2(0, -2), ivec2(1, 1),
                         ivec2(-1, 1), ivec2(1, -1), ivec2(-1, -1))[k];
    if (bodyAt(here + way) == chosen) return true;
  }
  return false;
}

vec3 toLight(vec3 c) { return pow(c, vec3(2.2)); }

void main() {
  extent = textureSize(surface, 0);
  ivec2 here = ivec2(gl_FragCoord.xy);
  float kind = kindAt(here);
  uint body = bodyAt(here);
  vec3 shown = paper;
  if (kind > 0.0) {
    vec3 point = pointAt(here);
    vec3 normal = normalAt(here);
    vec3 facing = normal * axes;
    bool section = abs(kind - SECTION) < 0.05;
    float open = section ? 1.0 : openness(here, point, facing);
    float light = (0.44 + 0.14 * normal.z) * open + 0.56 * max(dot(facing, lamp), 0.0) * (0.45 + 0.55 * open)
                + 0.16 * open * max(dot(facing, -normalize(point)), 0.0);
    vec3 own = mix(paper, vec3(0.5), 0.12);
    if (body > 0u) {
      int i = int(body) - 1;
      own = texelFetch(colours, ivec2(i % 256, i / 256), 0).rgb;
      if (section) own = mix(own, vec3(1.0), 0.18);
      light *= ink(here, body, kind, normal);
    }
    vec3 lit = pow(clamp(toLight(own) * light, 0.0, 1.0), vec3(1.0 / 2.2));
    shown = mix(paper, lit, body > 0u ? solidity : 1.0);
  }
  if (chosen > 0u && body != chosen && nearChosen(here)) shown = accent;
  if (chosen > 0u && body == chosen) shown = mix(shown, accent, 0.35);
  colour = vec4(shown, 1.0);
}
