// What the light is now: a preset or a script, changed by keys and controllers.
#pragma once

#include <optional>

#include "samples/common/xr_app.h"
#include "samples/demo/lights.h"

namespace samples {

class LightControl {
public:
    // Under a script the light follows it until a key or a controller takes over.
    LightControl(const Light& light, std::optional<LightScript> script) : light_(light), script_(std::move(script)) {}

    // Moves the script to `time` and applies held controllers. Depends on nothing but its arguments: lockstep repeats it.
    void update(const FrameTime& time, const ControllerInput& input);
    // Applies a key: d, u, n, s presets; l lamp; c ceiling; m moon; + and - dim the sky by a tenth of a decade. False: quit.
    bool press(char key);

    const Light& light() const { return light_; }

private:
    void dim_sky(double decades);

    Light light_;
    std::optional<LightScript> script_;
};

}  // namespace samples
