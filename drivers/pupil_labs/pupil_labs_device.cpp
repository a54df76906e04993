#include "drivers/pupil_labs/pupil_labs_device.h"

#include "drivers/uvc_camera/uvc_camera.h"

namespace entoptic::drivers {

Result<std::shared_ptr<EyeSource>> open_eye_cameras(Clock& clock, PictureTap tap) {
    if (find_eye_cameras(linux_video_system()).empty()) return missing(no_eye_cameras());
    PupilLabsOptions options;
    options.bypass = [&clock](const std::string& product, const CameraMode& mode) { return open_uvc_camera(product, mode, clock); };
    options.tap = std::move(tap);
    return std::make_shared<PupilLabsTracker>(clock, std::move(options));
}

namespace {

Result<std::shared_ptr<EyeSource>> open_eyes(Clock& clock) { return open_eye_cameras(clock, {}); }

}  // namespace

const Driver pupil_labs_driver{"pupil-labs", "Pupil Labs' binocular eye cameras", nullptr, open_eyes};

std::vector<EyeCameraNode> find_eye_cameras(VideoSystem& system) {
    std::vector<EyeCameraNode> found;
    for (const CameraNode& node : find_cameras(system))
        if (const auto eye = eye_of(node.name)) found.push_back({node, *eye});
    return found;
}

std::string no_eye_cameras() {
    return "No Pupil Labs eye camera (\"Pupil Cam... ID0\" or \"ID1\") can be opened. Plug them in, and see that you may open /dev/video* "
           "(group 'video').";
}

}  // namespace entoptic::drivers
