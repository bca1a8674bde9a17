layout(location = 0) out vec4 surface;
layout(location = 1) out vec4 number;
void main() {
  surface = vec4(0.5, 0.5, 1.0, 0.5);
  number = vec4(0.0);
}
