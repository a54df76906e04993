#include "samples/demo/light_control.h"

#include <algorithm>
#include <cmath>

namespace samples {

// Sky luminances that keys and controllers reach, cd/m²: below starlight and above a bright overcast day nothing changes.
constexpr double darkest_sky = 1e-4, brightest_sky = 1e4;

void LightControl::dim_sky(double decades) {
    script_.reset();
    light_.sky_cd_m2 = std::clamp(light_.sky_cd_m2 * std::pow(10.0, decades), darkest_sky, brightest_sky);
    light_.ceiling = std::clamp(light_.ceiling * std::pow(10.0, decades), 0.0, 1.0);
}

void LightControl::update(const FrameTime& time, const ControllerInput& input) {
    if (script_) { light_ = script_->at(time.seconds); }
    constexpr float dead_zone = 0.15F;
    constexpr double decades_per_second = 0.5;  // day to starlight in 13 s
    if (std::abs(input.dim) > dead_zone) { dim_sky(static_cast<double>(input.dim) * decades_per_second * time.period_seconds); }
    if (input.toggle) { press('l'); }
}

bool LightControl::press(char key) {
    const auto take = [this](const char* preset) {
        script_.reset();
        light_ = preset_light(preset);
    };
    const auto toggle = [this](double& source) {
        script_.reset();
        source = source > 0 ? 0 : 1;
    };
    switch (key) {
        case 'd':
            take("day");
            break;
        case 'u':
            take("dusk");
            break;
        case 'n':
            take("night");
            break;
        case 's':
            take("starlight");
            break;
        case 'l':
            toggle(light_.lamp);
            break;
        case 'c':
            toggle(light_.ceiling);
            break;
        case 'm':
            toggle(light_.moon);
            break;
        case '+':
            dim_sky(0.1);
            break;
        case '-':
            dim_sky(-0.1);
            break;
        case 'q':
            return false;
        default:
            break;
    }
    return true;
}

}  // namespace samples
