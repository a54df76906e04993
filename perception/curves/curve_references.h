// Curves in double from the published equations, with none of the shaders' text. Parameters of a model come as its list of numbers.
#pragma once

#include "perception/curves/curve.h"

#include <array>

namespace entoptic::perception::curve_reference {

using Triple = std::array<double, 3>;

double pupil_diameter(const CurveInput& in, double cd_m2);
double krawczyk_exp_linear_step(const CurveInput& in, double t_s);
double krawczyk_exp_log_step(const CurveInput& in, double t_s);
double jacobs_ramp_step(const CurveInput& in, double t_s);
double pattanaik_slow_step(const CurveInput& in, double t_s);
double key_reinhard_response(const CurveInput& in, double cd_m2);
double naka_rushton_response(const CurveInput& in, double cd_m2);
double display_identity_response(const CurveInput& in, double cd_m2);
double luidolt_eq12_sigma(const CurveInput& in, double cd_m2);
double luidolt_eq12_cutoff(const CurveInput& in, double cd_m2);
double larson_cutoff_cpd(const CurveInput& in, double cd_m2);
double larson_sigma(const CurveInput& in, double cd_m2);
double krawczyk_larson_sigma(const CurveInput& in, double cd_m2);
double jacobs_bands_cutoff(const CurveInput& in, double cd_m2);
double jacobs_bands_sigma(const CurveInput& in, double cd_m2);
double luidolt_tint_cone_share(const CurveInput& in, double cd_m2);
double krawczyk_tint_cone_share(const CurveInput& in, double cd_m2);
double jacobs_mesopic_cone_share(const CurveInput& in, double cd_m2);
double mes2_cone_share(const CurveInput& in, double cd_m2);
Triple jacobs_bleaching(const CurveInput& in, double t_s);
double jacobs_calcium(const CurveInput& in, double t_s);
double dioptric_disc(const CurveInput& in, double distance_m);
double liu_range_disc(const CurveInput& in, double distance_m);
double thibos_defocus(const CurveInput& in, double nm);
double exact_eccentricity(const CurveInput& in, double rho);
double fitted_eccentricity(const CurveInput& in, double rho);

std::vector<double> closed_form_scatter(const CurveInput& in, std::span<const double> degrees);
std::vector<double> luidolt_spectral_scatter(const CurveInput& in, std::span<const double> degrees);
std::vector<double> fraunhofer_mask_scatter(const CurveInput& in, std::span<const double> degrees);
std::vector<double> cie135_scatter(const CurveInput& in, std::span<const double> degrees);

}  // namespace entoptic::perception::curve_reference
