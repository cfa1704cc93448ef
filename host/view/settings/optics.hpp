// optics.hpp -- which kinds of lights and of surfaces kernels are compiled for, and what they write besides.
#pragma once
#include "rt_types.h"

namespace clarity {

// Kernels that know more of them make the same pictures.
struct Optics {
    rt_u32 lights = 0;   // bits of RT_LIGHTS
    rt_u32 lobes = 0;    // bits of RT_LOBES
    rt_u32 cutouts = 0;  // not 0: of some material alpha counts
    // Not 0: `path` writes the denoiser's guides (cl/tracers/path/guides.h). No property of a view: whoever prepares asks for
    // them.
    rt_u32 guides = 0;
    bool covers(const Optics& o) const { return (*this | o) == *this; }
    bool operator==(const Optics& o) const {
        return lights == o.lights && lobes == o.lobes && cutouts == o.cutouts && guides == o.guides;
    }
    bool operator!=(const Optics& o) const { return !(*this == o); }
    Optics operator|(const Optics& o) const {
        return {lights | o.lights, lobes | o.lobes, cutouts | o.cutouts, guides | o.guides};
    }
    // What Whitted's model tells apart: point lights alone, plain lights, and all.
    Optics for_whitted() const;
};

}  // namespace clarity
