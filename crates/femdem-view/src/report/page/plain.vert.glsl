layout(location = 0) in vec3 point;
uniform mat4 camera;
void main() {
  gl_Position = camera * vec4(point, 1.0);
}
