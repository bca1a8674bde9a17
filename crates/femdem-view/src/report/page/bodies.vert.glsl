// A body: its shape turned and put in its place.
layout(location = 0) in vec3 point;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 place;
layout(location = 3) in vec4 turn;

uniform mat4 camera;
uniform vec3 origin;
uniform vec3 size;
uniform vec4 cut;    // what has dot(cut.xyz, p) > cut.w is cut away
uniform float reach; // a body goes when its centre is this far beyond the cut
uniform uint first;  // number of the first body of this shape

flat out vec3 facing;
flat out uint body;
out vec3 at;

vec3 turned(vec4 q, vec3 v) {
  return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v);
}

void main() {
  vec3 centre = origin + place * size;
  vec4 q = normalize(turn);
  at = centre + turned(q, point);
  facing = turned(q, normal);
  body = first + uint(gl_InstanceID) + 1u;
  bool gone = dot(cut.xyz, centre) - cut.w > reach;
  gl_Position = gone ? vec4(2.0, 2.0, 2.0, 1.0) : camera * vec4(at, 1.0);
}
