// How wide a pupil is at a given light: Watson and Yellott 2012, "A unified formula for light-adapted pupil size", J. Vision 12(10):12.
// What is used where no eye tracker measures the pupil.
#pragma once

namespace entoptic::perception {

// Diameter of the entrance pupil in mm, 1.5..9.
//   luminance_cd_m2   mean luminance of the adapting field; the formula holds for 1e-5..1e4; brought into 0..1e8, NaN is 0
//   age               years; the formula holds for 20..83 and is held at these ends outside
//   area_deg2         area of the adapting field, deg²; 8495 for a disc of 104 degrees; at most 41253, NaN means no light
//   eyes              2 when both eyes see the light; 1 counts a tenth of the flux
double pupil_diameter_mm(double luminance_cd_m2, double age, double area_deg2, int eyes);

}  // namespace entoptic::perception
