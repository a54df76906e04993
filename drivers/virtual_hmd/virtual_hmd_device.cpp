#include "drivers/virtual_hmd/virtual_hmd_device.h"

#include "drivers/optics/lens_fov.h"
#include "drivers/virtual_hmd/virtual_hmd_time.h"

#include <fmt/format.h>

namespace entoptic::drivers {

namespace {

constexpr std::size_t kept_haptic_events = 1024;

ChannelDistortion distortion(float mirror, float centre_x, float centre_y, glm::vec3 coefficients) {
    return {{mirror * centre_x, centre_y}, coefficients};
}

Result<Headset> open(const DriverOptions& options) {
    ENTOPTIC_TRY(hmd, make_virtual_hmd(options));
    return headset_of(hmd, options);
}

}  // namespace

const Driver virtual_hmd_driver{"virtual", "a Vive Pro without hardware; a script moves its wearer", open};

// The numbers are those of facts/devices.md's example file; the right eye is the left one mirrored.
Lens virtual_lens(int eye) {
    const float mirror = eye == 0 ? 1.0f : -1.0f;
    Lens lens;
    lens.channels = {distortion(mirror, 0.0807f, 0.0018f, {-0.1598f, -0.0435f, -0.0218f}),
                     distortion(mirror, 0.0810f, 0.0021f, {-0.1912f, -0.0274f, -0.0431f}),
                     distortion(mirror, 0.0814f, 0.0024f, {-0.2231f, -0.0105f, -0.0662f})};
    lens.aspect = 0.9f;
    lens.grow_for_undistort = 0.6f;
    lens.r2_cutoff = 1.11f;
    lens.focal = {1.2f, 1.08f};
    lens.principal_point = {mirror * -0.081f, -0.0021f};
    return lens;
}

DisplayIdentity virtual_display(int panel_width, int panel_height) {
    DisplayIdentity display;
    display.name = "HTC Vive Pro (virtual)";
    display.panel_width = panel_width;
    display.panel_height = panel_height;
    display.refresh_numerator = 90;
    display.refresh_denominator = 1;
    display.period = display.refresh_time(0, 1);
    // The file's seconds_from_vsync_to_photons (0.111 ms) and half of its persistence (2.11 ms).
    display.vblank_to_photon = 111'000 + 2'110'000 / 2;
    display.photometry = {130, 0.04f};
    return display;
}

PoseState VirtualHead::pose_at(TimeNs time) { return head_at(script_, elapsed_since(start_time_, time)); }

ControllerState VirtualController::state_at(TimeNs time) { return controller_at(script_, hand_, elapsed_since(start_time_, time)); }

void VirtualController::vibrate(TimeNs time, DurationNs duration, float frequency_hz, float amplitude) {
    const std::lock_guard lock(mutex_);
    if (events_.size() == kept_haptic_events) events_.erase(events_.begin());
    events_.push_back({time, duration, frequency_hz, amplitude});
}

std::vector<HapticEvent> VirtualController::haptic_events() const {
    const std::lock_guard lock(mutex_);
    return events_;
}

VirtualHmd::VirtualHmd(const DriverOptions& options, Script script)
    : script_(std::move(script)),
      head_(script_, options.start_time),
      eyes_(script_, options.ipd_mm, options.seed, !options.ideal_tracker),
      eye_tracker_(script_, options.ideal_tracker ? ideal_tracker(script_.tracker) : script_.tracker, eyes_, options.seed,
                   options.start_time, {lens_fov(virtual_lens(0)), lens_fov(virtual_lens(1))}),
      left_(script_, options.start_time, 0),
      right_(script_, options.start_time, 1) {}

Result<std::shared_ptr<VirtualHmd>> make_virtual_hmd(const DriverOptions& options) {
    const auto size_ok = [](int pixels) { return pixels >= 16 && pixels <= 8192; };
    if (!size_ok(options.panel_width) || !size_ok(options.panel_height))
        return usage_error(fmt::format("A panel of {}x{} pixels an eye is not possible; give 16 to 8192 each way.", options.panel_width,
                                       options.panel_height));
    if (!(options.ipd_mm >= 50 && options.ipd_mm <= 80))
        return usage_error(fmt::format("An IPD of {:g} mm is not possible; give 50 to 80 mm.", options.ipd_mm));
    ENTOPTIC_TRY(script, load_script(options.script));
    return std::make_shared<VirtualHmd>(options, std::move(script));
}

Headset headset_of(const std::shared_ptr<VirtualHmd>& hmd, const DriverOptions& options) {
    Headset headset;
    headset.display = virtual_display(options.panel_width, options.panel_height);
    for (int side = 0; side < 2; ++side) {
        const auto i = static_cast<std::size_t>(side);
        EyeOptics& optics = headset.eyes[i];
        optics.lens = virtual_lens(side);
        optics.fov = lens_fov(optics.lens);
        optics.head_from_eye.position.x = static_cast<float>((side == 0 ? -0.5e-3 : 0.5e-3) * options.ipd_mm);
        if (hmd->script().controllers[i].enabled) headset.controllers[i] = &hmd->controller(side);
    }
    headset.head = &hmd->head();
    headset.eye_tracker = &hmd->eye_tracker();
    headset.presence = &hmd->presence();
    headset.play_area_m = {4, 4};  // choice: a room of 4 m x 4 m, with the world's origin in its middle
    headset.owner = hmd;
    return headset;
}

}  // namespace entoptic::drivers
