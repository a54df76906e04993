#version 460
// One triangle over the whole image; `screen` runs from (0, 0) at the top left to (1, 1).
layout(location = 0) out vec2 screen;

void main() {
    screen = vec2((gl_VertexIndex << 1) & 2, gl_VertexIndex & 2);
    gl_Position = vec4(screen * 2.0 - 1.0, 0.0, 1.0);
}
