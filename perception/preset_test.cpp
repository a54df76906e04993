#include "perception/doubling.h"

#include <cmath>
#include <gtest/gtest.h>

namespace entoptic::perception {
namespace {

std::string refusal(const char* preset, const std::vector<std::string>& models, const std::vector<std::string>& settings, Viewer viewer) {
    const auto selection = select(preset, models, settings);
    if (!selection) return "not selected: " + selection.error().message;
    const auto good = expect_no_doubling(*selection, viewer);
    return good ? "" : good.error().message;
}

TEST(Doubling, PresetsHaveNone) {
    for (const Preset& preset : presets())
        for (Viewer viewer : {Viewer::wearer, Viewer::onlooker, Viewer::reader})
            EXPECT_EQ(refusal(std::string(preset.name).c_str(), {}, {}, viewer), "") << preset.name;
}

TEST(Doubling, WhatTheWearersEyeDoesIsRefusedForAWearerOnly) {
    struct Case {
        std::vector<std::string> models, settings;
        const char* says;
    };
    const Case cases[] = {
        {{"acuity=luidolt_eq12"}, {}, "acuity=luidolt_eq12 with tone=display_identity counts an effect twice"},
        {{"acuity=krawczyk_larson"}, {}, "acuity=larson_increment"},
        {{"acuity=jacobs_bands"}, {"acuity.eccentricity_per_deg=0.3"}, "falls off beside the gaze"},
        {{}, {"acuity.photographic=1"}, "acuity.photographic with tone=display_identity"},
        {{"mesopic=luidolt_tint"}, {}, "own rods"},
        {{"mesopic=krawczyk_tint"}, {"mesopic.photographic=1"}, "own rods"},
        {{}, {"glare.photographic=1"}, "already scatters"},
        {{}, {"afterimage.photographic=1"}, "its own afterimages"},
        {{"dof=dioptric_disc"}, {"dof.lca=1"}, "colours the edges"},
    };
    for (const Case& c : cases) {
        EXPECT_NE(refusal("combined", c.models, c.settings, Viewer::wearer).find(c.says), std::string::npos)
            << c.says << ": " << refusal("combined", c.models, c.settings, Viewer::wearer);
        EXPECT_NE(refusal("combined", c.models, c.settings, Viewer::onlooker), "") << c.says;
        EXPECT_EQ(refusal("combined", c.models, c.settings, Viewer::reader), "") << c.says;
        // A tone map that does not show the scene as it is makes no such promise.
        std::vector<std::string> other = c.models;
        other.push_back("tone=key_reinhard");
        EXPECT_EQ(refusal("combined", other, c.settings, Viewer::wearer), "") << c.says;
    }
}

TEST(Doubling, OnlyTheWearersOwnLidIsThere) {
    EXPECT_NE(refusal("combined", {"eyelid=blink"}, {}, Viewer::wearer).find("eyelid=blink counts an effect twice: the wearer's own lid"),
              std::string::npos);
    EXPECT_NE(refusal("luidolt2020", {"eyelid=blink"}, {}, Viewer::wearer), "");
    EXPECT_EQ(refusal("combined", {"eyelid=blink"}, {}, Viewer::onlooker), "");
}

TEST(Doubling, ModelsThatAddTheDifferenceAreNotRefused) {
    for (const char* model : {"acuity=larson_increment", "acuity=jacobs_bands", "mesopic=mes2", "mesopic=krawczyk_tint", "glare=cie135", "glare=luidolt_spectral",
                              "glare=fraunhofer_mask", "dof=dioptric_disc", "dof=liu_range", "adaptation=pattanaik_slow"})
        EXPECT_EQ(refusal("combined", {model}, {}, Viewer::wearer), "") << model;
}

// The ends of a range such as 0.1 to 2 are floats: 0.1 itself lies a rounding below its own float.
TEST(Ranges, IncludeTheirEnds) {
    for (const ModelEntry* entry : models())
        for (const ParameterInfo& p : entry->parameters) {
            EXPECT_TRUE(p.allows(static_cast<double>(p.min)) && p.allows(static_cast<double>(p.max))) << p.name;
            EXPECT_FALSE(p.allows(static_cast<double>(p.max) + 0.01 * (1 + static_cast<double>(std::abs(p.max)))) || p.allows(std::nan(""))) << p.name;
        }
    EXPECT_TRUE(select("off", {"noise=rod_noise"}, {"noise.grain_deg=0.1"}));
    EXPECT_FALSE(select("off", {"noise=rod_noise"}, {"noise.grain_deg=0.0999"}));
}

TEST(Ranges, TheLesserIsNotAboveTheGreater) {
    const auto said = [](const char* model, const char* setting) {
        const auto selection = select("off", {model}, {setting});
        return selection ? "" : selection.error().message;
    };
    EXPECT_EQ(said("pupil=residual_pupil", "pupil.least_mm=8.5"), "pupil.least_mm = 8.5 must not be above pupil.most_mm = 8.");
    EXPECT_NE(said("pupil=luidolt_pupil", "pupil.white_mm=7"), "");
    EXPECT_NE(said("scotoma=foveal_scotoma", "scotoma.inner_deg=9"), "");
    EXPECT_EQ(said("pupil=residual_pupil", "pupil.least_mm=8"), "");
}

TEST(Doubling, TwoToneCurvesAreRefusedForEverybody) {
    for (Viewer viewer : {Viewer::wearer, Viewer::reader}) {
        EXPECT_NE(refusal("kakimoto2004", {"tone=naka_rushton"}, {}, viewer).find("two tone curves"), std::string::npos);
        EXPECT_EQ(refusal("kakimoto2004", {"tone=naka_rushton"}, {"glare.sigmoid=0"}, viewer), "");
    }
}

}  // namespace
}  // namespace entoptic::perception
