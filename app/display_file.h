// A display's file: what a light meter read through each lens. displays/NAME.toml in the configuration's folder:
//
//   description = "Vive Pro of room 3"
//   instrument = "spot photometer, field of 1 degree"
//   [both]                                     # or [left] and [right]
//   readings = [
//     [0, 0, 0, 0.05],                         # codes of red, green and blue; luminance in cd/m2
//     [255, 0, 0, 0.640, 0.330, 28.1],         # or, with a colorimeter, CIE 1931 x and y before it
//   ]
//
// The file holds readings only, so that a better fit can be made of them later.
#pragma once

#include "base/result.h"
#include "interfaces/headset.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace entoptic::app {

struct MeterReading {
    std::array<int, 3> codes{};               // of red, green and blue, 0..255
    std::optional<glm::dvec2> xy;             // CIE 1931 chromaticity; none: a photometer
    double luminance_cd_m2 = 0;
    std::string place;                        // file and line, for messages
};

struct DisplayFile {
    std::string name, description, instrument;
    std::array<std::vector<MeterReading>, 2> eyes;      // left, right
};

// A file's text; errors name file, line and what is allowed.
Result<DisplayFile> read_display_file(const std::string& path);
// displays/NAME.toml of the configuration's folder, or a path that ends in .toml.
Result<DisplayFile> find_display_file(const std::string& name_or_path);

// How a panel's light follows from its readings:
//   black     of code 0 in all channels: needed
//   channels  255 in one channel alone, less the black; those without x and y have BT.709's. Where one of the three is missing: 255 in all
//             channels, shared out as BT.709 shares its white
//   curve     readings of one channel alone and those with equal codes, by their colour or else their luminance; sRGB's where there are none.
//             Between readings a monotone cubic (Fritsch and Carlson 1980) of the light to the power 1/2.2
Result<MeasuredPanel> fit_panel(const std::vector<MeterReading>& readings);

// What a pixel of these codes sends: linear BT.709, cd/m². Of a measured panel, and of a nominal one (BT.709, sRGB, D65).
glm::dvec3 light_of_codes(const MeasuredPanel& panel, const std::array<int, 3>& codes);
glm::dvec3 nominal_light_of_codes(const Photometry& nominal, const std::array<int, 3>& codes);

// Luminance and colours of the compositor: the brightest D65 white that both eyes can show, the brighter black.
Result<Photometry> measured_photometry(const DisplayFile& file);

// CIE 1931, two degrees.
struct Chromaticity {
    double x = 0, y = 0, luminance_cd_m2 = 0;
    glm::dvec2 uv() const;                    // CIE 1976 u', v'
};
Chromaticity chromaticity_of(glm::dvec3 bt709_cd_m2);
glm::dvec3 light_of(const Chromaticity& colour);          // linear BT.709, cd/m²

// How well a panel's model says what the meter read.
struct DisplayCheck {
    struct Row {
        MeterReading reading;
        double nominal_cd_m2 = 0;             // what the nominal panel would send
        double fitted_cd_m2 = 0;              // by the fit
        std::optional<double> held_out_cd_m2; // by the fit of readings of other codes; none for codes of 0 and 255, which it needs
        std::optional<double> nominal_duv, fitted_duv;      // distance in CIE 1976 u'v'
    };
    std::vector<Row> rows;
    std::optional<double> additivity;         // luminance of white over the sum of its channels, less 1; both less the black
};
Result<DisplayCheck> check_display(const std::vector<MeterReading>& readings, const Photometry& nominal);

}  // namespace entoptic::app
