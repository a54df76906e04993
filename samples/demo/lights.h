// The light of the office: four sources from day to starlight, their photometry and colours, presets and scripts.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

namespace samples {

// ---- photometry of the sources ----

// The lamp: a 60 W incandescent bulb, 710 lm (EU regulation 244/2009), frosted inside, 60 mm in diameter. Were it uniform, it
// would have 710 lm / (pi * 4 pi (0.03 m)²) = 2.0e4 cd/m²; frosted inside, it is brightest in front of the filament, 1.2e5 cd/m²
// (IESNA Lighting Handbook, table of source luminances). bulb_profile() joins the two numbers.
constexpr double bulb_radius_m = 0.03;
constexpr double bulb_flux_lm = 710.0;
constexpr double bulb_peak_cd_m2 = 1.2e5;
constexpr double bulb_edge_share = 0.08;  // luminance at the rim over the peak; the part that does not follow the filament

// The exponent p for which a sphere of luminance peak * (edge + (1 - edge) mu^p), mu the cosine between normal and line of
// sight, gives the flux above: flux = 2 pi A peak (edge / 2 + (1 - edge) / (p + 2)).
double bulb_profile_exponent();

// A 0.6 m square LED panel of 3600 lm: L = flux / (pi A).
constexpr double panel_cd_m2 = 3600.0 / (3.14159265358979 * 0.36);

// The full moon: 0.25 lx on a surface facing it, a disc of half a degree: 0.25 / 6.5e-5 sr.
constexpr double moon_lux = 0.25;
constexpr double moon_cd_m2 = 3850.0;

constexpr double power_led_cd_m2 = 60.0;

// ---- the state of the light ----

struct Light {
    double sky_cd_m2 = 0;  // luminance of the sky in the window
    double moon = 0;       // 0 … 1 of the full moon
    double ceiling = 0;    // 0 … 1 of the panel's luminance
    double lamp = 0;       // 0 … 1 of the lamp's flux
};

struct Preset {
    std::string_view name;
    Light light;
};

// Skies: overcast noon 5000 cd/m²; dusk 5, half an hour after sunset; clear sky under a full moon 0.02 (with a town's haze);
// moonless 0.002 (19 mag/arcsec², a small town; far from any it would be 2e-4).
constexpr std::array<Preset, 4> presets{{
    {"day", {5000.0, 0, 1, 0}},
    {"dusk", {5.0, 0, 0, 1}},
    {"night", {0.02, 1, 0, 1}},
    {"starlight", {0.002, 0, 0, 0}},
}};

// Throws Failure (usage) for an unknown name.
Light preset_light(std::string_view name);

// Lights over time: keyframes, between which the sky is interpolated in its logarithm and the rest linearly; before the first
// and after the last the light stands still.
class LightScript {
public:
    struct Keyframe {
        double seconds;
        Light light;
    };
    explicit LightScript(std::vector<Keyframe> keyframes) : keyframes_(std::move(keyframes)) {}
    // CSV with the columns time_s,sky_cd_m2,moon,ceiling,lamp; a header line and lines beginning with # are skipped.
    // Throws Failure (usage) that names file and line.
    static LightScript load(const std::string& path);
    // Day to starlight in 60 s, the lamp on from dusk until the last 10 s, and back in the next 60 s; repeats.
    static LightScript day_cycle();

    Light at(double seconds) const;

private:
    std::vector<Keyframe> keyframes_;
    double period_ = 0;  // s; 0: does not repeat
};

// The light of each lightmap channel (bake.h) as linear Rec.709 RGB whose luminance is the source's: cd/m² for the sky and
// the panel, lm for the lamp, lx for the moon. `lamp_peak_cd_m2` is the bulb's when it is fully on.
std::array<glm::vec3, 4> channel_colours(const Light& light, double lamp_peak_cd_m2);

// Colour of a black body, linear Rec.709 with luminance 1; 1667 K … 25000 K.
glm::vec3 blackbody(double kelvin);

// The smallest power of two, in cd/m² per unit, with which `brightest_cd_m2` stays in fp16's range (65504 units), within the
// 2^-19 … 2^19 that XR_ENTOPTICX_scene_luminance takes. A power of two, so that pre-exposing loses nothing but range. In the
// dark the whole scale moves down with it: at 2^-14 a paper of 1e-4 cd/m² is 1.6 units, far above the smallest normal 6.1e-5.
float pre_exposure(double brightest_cd_m2);

}  // namespace samples
