// People whose eyes come with the program: how they differ from the default one, 30 years old with brown eyes. As in all files, that default
// eye is also the one which looks at the display (docs/observers.md).
#include "app/observer_file.h"

namespace entoptic::app {

std::span<const BuiltInObserver> built_in_observers() {
    static constexpr BuiltInObserver table[] = {
        {"young", R"(description = "20 years, brown eyes"
[settings]
glare.age = 20              # CIE 146:2002: straylight grows with 1 + (age/62.5)^4
pupil.age = 20              # Watson and Yellott 2012
)"},
        {"70-years", R"(description = "70 years, brown eyes, healthy"
[settings]
glare.age = 70              # CIE 146:2002: 1 + (age/62.5)^4 is 2.4 times that of age 30
pupil.age = 70              # Watson and Yellott 2012: a smaller pupil in the dark
adaptation.speed = 0.5      # choice: rods recover more slowly with age (Jackson, Owsley and McGwin 1999); the number is ours
)"},
        {"early-cataract", R"(description = "65 years with an early cataract"
[settings]
glare.age = 65
glare.straylight_factor = 2 # choice: log s up by 0.3, to about 1.45 log units
pupil.age = 65
)"},
        {"night-driver", R"(description = "45 years, light eyes: more straylight of headlamps"
[settings]
glare.age = 45
glare.pigment = 1.2         # CIE 146:2002: light blue
glare.straylight_colour = 0 # choice: white; light eyes add red light to the straylight of brown ones (Coppens 2006), but at one luminance their
                            # difference would take blue away
pupil.age = 45
)"},
    };
    return table;
}

}  // namespace entoptic::app
