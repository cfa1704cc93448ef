#include "view/settings/optics.hpp"

namespace clarity {

Optics Optics::for_whitted() const {
    const rt_u32 point = 1u << RT_LIGHT_POINT, given = lights & (RT_LIGHTS_GIVEN | RT_LIGHTS_FADE);
    if ((given & ~point) == 0) return {point, 0, cutouts};
    return {(given & ~RT_LIGHTS_PLAIN) == 0 ? RT_LIGHTS_PLAIN : RT_LIGHTS_ALL, 0, cutouts};
}

}  // namespace clarity
