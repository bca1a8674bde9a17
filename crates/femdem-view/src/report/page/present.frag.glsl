// The finished picture onto the canvas: the mean of the pixels drawn for each pixel of the screen.
uniform sampler2D picture;
uniform vec2 screen;
out vec4 colour;
void main() {
  colour = texture(picture, gl_FragCoord.xy / screen);
}
