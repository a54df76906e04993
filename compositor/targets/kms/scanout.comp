#version 450
#extension GL_EXT_scalar_block_layout : require

// Both eyes' codes (R in the low byte, one eye after the other) into one picture that a display scans out: eyes side by side, XRGB8888
// (B in the low byte), rows `pitch` words apart.
layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer Codes { uint codes[]; };
layout(scalar, binding = 1) writeonly buffer Picture { uint picture[]; };

layout(scalar, push_constant) uniform Push {
    uint width, height;  // of one eye
    uint pitch;
} push;

void main() {
    const uint x = gl_GlobalInvocationID.x, y = gl_WorkGroupID.y, eye = gl_WorkGroupID.z;
    if (x >= push.width) return;
    const uint code = codes[(eye * push.height + y) * push.width + x];
    picture[y * push.pitch + eye * push.width + x] = (code & 0xff00ff00u) | (code & 0xffu) << 16 | (code >> 16 & 0xffu);
}
