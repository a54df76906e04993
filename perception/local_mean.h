// Local means of luminance over a window of some degrees, for models that ask what a patch of the retina is adapted to: on a grid of
// nodes, from the picture as it stands when record() is called.
#pragma once

#include "perception/local_mean_grid.h"
#include "perception/model.h"

namespace entoptic::perception {

class LocalMean {
public:
    static Result<LocalMean> create(const ModelContext& context);
    // Three dispatches of `gate.dispatch[nodes_dispatch]` workgroups (node_groups(), 1, views; or zero). Leaves a barrier behind.
    void record(StageIo& io, float diameter_deg, std::size_t nodes_dispatch);

    const LocalMeanGrid& grid() const { return grid_; }
    // Workgroups of 64 nodes of one view.
    uint node_groups() const { return gpu::groups_for(grid_.nodes_x * grid_.nodes_y, 64); }
    const gpu::Buffer& cells() const { return cells_; }   // LocalCell a node, rows, then views
    const gpu::Buffer& means() const { return means_; }   // float a node: cd/m²; 0 far from anything visible

private:
    LocalMeanGrid grid_{};
    gpu::Buffer cells_, rows_, means_;
    gpu::Kernel sum_cells_, sum_rows_, sum_columns_;
};

// The same by the definition, in double: at each pixel the mean over all pixels within 5 sigma of the window, by the angle between their
// directions and by solid angle. Slow.
ImageD local_mean_reference(const ImageD& image, const EyeGeometry& geometry, double diameter_deg);

}  // namespace entoptic::perception
