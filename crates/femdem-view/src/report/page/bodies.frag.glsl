// What is where: the normal and the kind of surface, and the number of the body.
// With CUT, the inside of a body that the cut has opened shows the cut itself.
flat in vec3 facing;
flat in uint body;
in vec3 at;

layout(location = 0) out vec4 surface;
layout(location = 1) out vec4 number;

#ifdef CUT
uniform vec4 cut;
#endif

const float FACE = 1.0;
const float SECTION = 0.75;

void main() {
  vec3 normal = facing;
  float kind = FACE;
#ifdef CUT
  if (dot(cut.xyz, at) > cut.w) discard;
  if (!gl_FrontFacing) {
    normal = cut.xyz;
    kind = SECTION;
  }
#endif
  surface = vec4(0.5 + 0.5 * normalize(normal), kind);
  number = vec4(uvec4(body, body >> 8, body >> 16, 255u) & 255u) / 255.0;
}
