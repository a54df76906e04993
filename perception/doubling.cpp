#include "perception/doubling.h"

#include <fmt/format.h>

namespace entoptic::perception {
namespace {

// A model, or a parameter of it that is not 0.
struct Part {
    const char* slot;
    const char* model;      // null: any; the slot null, too: nothing more is needed
    const char* parameter;  // null: the model itself
};

struct Doubling {
    Part first, second;
    Viewer last;  // for viewers up to this one
    const char* why;
    const char* instead;
};

// display_identity shows what the panel can show as it is, so the wearer's eye does to it what it does to any light. The other tone maps make
// pictures of a night out of the light of a day; there the papers' plain forms stand, doublings of the wearer's eye and all.
constexpr Part as_it_is{"tone", "display_identity", nullptr};
constexpr Doubling doublings[] = {
    {as_it_is,
     {"acuity", "luidolt_eq12", nullptr},
     Viewer::onlooker,
     "the wearer's own eye already loses that acuity where the panel is dark",
     "acuity=larson_increment, which adds the difference only"},
    {as_it_is,
     {"acuity", "krawczyk_larson", nullptr},
     Viewer::onlooker,
     "the wearer's own eye already loses that acuity where the panel is dark",
     "acuity=larson_increment, which adds the difference only"},
    {as_it_is,
     {"acuity", nullptr, "photographic"},
     Viewer::onlooker,
     "the wearer's own eye already loses that acuity where the panel is dark",
     "acuity.photographic=0"},
    {as_it_is,
     {"acuity", nullptr, "eccentricity_per_deg"},
     Viewer::onlooker,
     "the wearer's own acuity already falls off beside the gaze",
     "acuity.eccentricity_per_deg=0"},
    {as_it_is,
     {"mesopic", "luidolt_tint", nullptr},
     Viewer::onlooker,
     "the wearer's own rods already see what the panel shows that dark",
     "mesopic=jacobs_mesopic, which adds the difference only"},
    {as_it_is,
     {"mesopic", nullptr, "photographic"},
     Viewer::onlooker,
     "the wearer's own rods already see what the panel shows that dark",
     "mesopic.photographic=0"},
    {as_it_is,
     {"glare", nullptr, "photographic"},
     Viewer::onlooker,
     "the wearer's own eye already scatters what the panel shows",
     "glare.photographic=0"},
    {as_it_is,
     {"afterimage", nullptr, "photographic"},
     Viewer::onlooker,
     "the panel's light already leaves the wearer its own afterimages",
     "afterimage.photographic=0"},
    {as_it_is,
     {"dof", nullptr, "lca"},
     Viewer::onlooker,
     "the lens of the wearer's own eye already colours the edges of what the panel shows",
     "dof.lca=0"},
    {{nullptr, nullptr, nullptr},
     {"eyelid", "blink", nullptr},
     Viewer::wearer,
     "the wearer's own lid already darkens the panel",
     "eyelid=none"},
    {{"glare", "fraunhofer_mask", "sigmoid"},
     {"tone", nullptr, nullptr},
     Viewer::reader,
     "the veil would be mapped by two tone curves",
     "glare.sigmoid=0 or tone=none"},
};

bool is_chosen(const Part& part, const Selection& selection) {
    if (!part.slot) return true;
    const Choice* choice = selection.find(part.slot);
    if (!choice || (part.model && choice->entry->name != part.model)) return false;
    if (!part.parameter) return true;
    for (std::size_t i = 0; i < choice->entry->parameters.size(); ++i)
        if (std::string_view(choice->entry->parameters[i].name) == part.parameter) return choice->parameters[i] != 0;
    return false;
}

std::string said(const Part& part, const Selection& selection) {
    if (part.parameter) return fmt::format("{}.{}", part.slot, part.parameter);
    return fmt::format("{}={}", part.slot, selection.find(part.slot)->entry->name);
}

}  // namespace

Result<void> expect_no_doubling(const Selection& selection, Viewer viewer) {
    for (const Doubling& d : doublings) {
        if (viewer > d.last || !is_chosen(d.first, selection) || !is_chosen(d.second, selection)) continue;
        const std::string with = d.first.slot ? " with " + said(d.first, selection) : "";
        return usage_error(fmt::format("{}{} counts an effect twice: {}. Choose {}.", said(d.second, selection), with, d.why, d.instead));
    }
    return {};
}

}  // namespace entoptic::perception
