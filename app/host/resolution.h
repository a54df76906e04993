// The detail that an eye resolves, for applications that draw no more (XR_ENTOPTICX_observer).
#pragma once

namespace entoptic::app {

// Half a period of the finest grating that an eye adapted to `cd_m2` (finite) resolves where it looks, rad: Larson, Rushmeier and Piatko 1997 after
// Shlaer 1937. In total darkness that of a tenth of a cycle a degree.
double resolved_angle_rad(double cd_m2);

}  // namespace entoptic::app
