// The window of a local mean, and values between the nodes of its grid. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_LOCAL_MEAN_MATH_GLSL
#define ENTOPTIC_PERCEPTION_LOCAL_MEAN_MATH_GLSL

#include "perception/local_mean_grid.h"

ENTOPTIC_MATH_BEGIN(perception)

// Standard deviation (degrees) of the Gaussian window that stands for a disc of this diameter: both have the same second moment.
FN real window_sigma_deg(real diameter_deg) { return LIT(0.25) * diameter_deg; }

// Standard deviation, in nodes, of the sampled Gaussian that is left to apply: cells average over their width (variance 1/12 node²),
// pixels interpolate between nodes (1/6). The least keeps nodes beside the rim of the lens from being empty.
FN real node_sigma(real diameter_deg, real ppd, uint cell) {
    real s = window_sigma_deg(diameter_deg) * ppd / real(cell);
    return sqrt(max(s * s - LIT(0.25), LIT(0.1225)));
}

// Nodes on each side that count: 5 sigma, so that a lamp leaves the window where it no longer matters; at most max_node_radius.
const int max_node_radius = 64;
FN int node_radius(real sigma) { return min(int(ceil(LIT(5.0) * sigma)), max_node_radius); }

// Where a pixel lies between nodes: index of the node above and left, and the part of the way to the next ones.
struct NodePlace {
    uint x0, x1, y0, y1;
    real along_x, along_y;
};
FN NodePlace node_place(LocalMeanGrid g, rvec2 px) {
    rvec2 at = px / real(g.cell) - rvec2(LIT(0.5), LIT(0.5));
    at = clamp(at, rvec2(LIT(0.0), LIT(0.0)), rvec2(real(g.nodes_x - 1u), real(g.nodes_y - 1u)));
    NodePlace p;
    p.x0 = uint(at.x);
    p.y0 = uint(at.y);
    p.x1 = min(p.x0 + 1u, g.nodes_x - 1u);
    p.y1 = min(p.y0 + 1u, g.nodes_y - 1u);
    p.along_x = at.x - real(p.x0);
    p.along_y = at.y - real(p.y0);
    return p;
}

// Bilinear; exactly the nodes' value where all four agree, so that a model that does nothing at the nodes does nothing between them.
FN real between_nodes(NodePlace p, real v00, real v10, real v01, real v11) {
    real top = v00 + (v10 - v00) * p.along_x, bottom = v01 + (v11 - v01) * p.along_x;
    return top + (bottom - top) * p.along_y;
}

ENTOPTIC_MATH_END

// The same from a buffer of nodes; a macro, because GLSL cannot pass buffers to functions.
#define ENTOPTIC_AT_NODES(nodes, grid, view, place)                                                                                 \
    between_nodes(place, nodes[((view) * (grid).nodes_y + (place).y0) * (grid).nodes_x + (place).x0],                               \
                  nodes[((view) * (grid).nodes_y + (place).y0) * (grid).nodes_x + (place).x1],                                      \
                  nodes[((view) * (grid).nodes_y + (place).y1) * (grid).nodes_x + (place).x0],                                      \
                  nodes[((view) * (grid).nodes_y + (place).y1) * (grid).nodes_x + (place).x1])

#endif
