// A tube from one end to the other, for one contact.
layout(location = 0) in vec2 corner; // angle in turns, 0 or 1 along the tube
layout(location = 1) in vec3 from;
layout(location = 2) in vec3 to;
layout(location = 3) in vec2 look;   // radius, strength 0 to 1

uniform mat4 camera;

out vec3 facing;
out vec3 at;
out float strength;

void main() {
  vec3 along = normalize(to - from);
  vec3 side = normalize(cross(along, abs(along.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0)));
  float angle = 6.28318531 * corner.x;
  facing = cos(angle) * side + sin(angle) * cross(along, side);
  at = mix(from, to, corner.y) + look.x * facing;
  strength = look.y;
  gl_Position = camera * vec4(at, 1.0);
}
