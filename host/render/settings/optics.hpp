// optics.hpp -- which kinds of lights and of surfaces kernels are compiled for.
#pragma once
#include "rt_types.h"

namespace clarity {

// Kernels that know more of them make the same pictures.
struct Optics {
    rt_u32 lights = 0;  // bits of RT_LIGHTS
    rt_u32 lobes = 0;   // bits of RT_LOBES
    bool covers(const Optics& o) const { return (o.lights & ~lights) == 0 && (o.lobes & ~lobes) == 0; }
    bool operator==(const Optics& o) const { return lights == o.lights && lobes == o.lobes; }
    bool operator!=(const Optics& o) const { return !(*this == o); }
    Optics operator|(const Optics& o) const { return {lights | o.lights, lobes | o.lobes}; }
    // What Whitted's model tells apart: point lights alone, plain lights, and all.
    Optics for_whitted() const;
};

}  // namespace clarity
