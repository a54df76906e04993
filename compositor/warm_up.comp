#version 450

// Does nothing: see warm_up.h.
layout(local_size_x = 1) in;

void main() {}
