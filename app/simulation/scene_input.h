// Pictures that `entoptic simulate` looks at: calibrated radiance maps, in cd/m².
#pragma once

#include "base/image.h"
#include "base/result.h"
#include "shaders/eye_geometry.h"

#include <optional>
#include <string>
#include <vector>

namespace entoptic::app {

struct SceneOptions {
    std::optional<double> luminance_scale;  // cd/m² of RGB (1,1,1); wins over the file's whiteLuminance
    std::optional<double> assume_white;     // the same, for files that do not say
    int downscale = 1;                      // averages squares of that many pixels a side
};

struct Scene {
    ImageF rgb;    // cd/m², 3 channels; may hold NaN, infinities, negatives
    ImageF depth;  // metres from the eye, 1 channel; empty when the file has no channel Z
    double cd_per_unit = 1;
    std::string scale_source;  // "whiteLuminance of lamp.exr"
};

Result<Scene> load_scene(const std::string& path, const SceneOptions& options);

// The files of `name`: itself, or for a numbered name all there are, from the lowest number on; a number left out between them is an error.
struct InputFile {
    std::string path;
    int number = 0;
};
Result<std::vector<InputFile>> input_files(const std::string& name);

enum class Projection { rectilinear, equirect };

// What directions a picture of this size shows. Without `projection`: rectilinear when `fov_deg` is given, equirect when the picture is
// twice as wide as high, else a usage error. `fov_deg` is horizontal.
Result<EyeGeometry> scene_geometry(std::optional<Projection> projection, std::optional<double> fov_deg, int width, int height);

// Mean luminance over solid angle, after the cleaning every picture gets (NaN and negatives 0, at most 1e8 cd/m²).
double mean_luminance(const ImageF& rgb, const EyeGeometry& geometry);
// Solid angle of the picture, square degrees.
double field_deg2(const EyeGeometry& geometry);

}  // namespace entoptic::app
