in vec3 facing;
in vec3 at;
in float strength;

uniform vec4 cut;
uniform vec3 lamp;
uniform vec3 eye;

out vec4 colour;

void main() {
  if (dot(cut.xyz, at) > cut.w) discard;
  vec3 normal = normalize(facing);
  vec3 weak = vec3(0.96, 0.66, 0.22);
  vec3 strong = vec3(0.70, 0.05, 0.20);
  vec3 own = mix(weak, strong, strength);
  float light = 0.55 + 0.35 * max(dot(normal, lamp), 0.0) + 0.2 * max(dot(normal, normalize(eye - at)), 0.0);
  colour = vec4(min(own * light, 1.0), 1.0);
}
