// sky_kinds.hpp -- the table of the kinds of skies and of their keys.
#pragma once
#include "scene/key.hpp"
#include "scene/sky.hpp"

namespace clarity {

struct SkyKind {
    rt_u32 kind = RT_NONE;   // RT_SKY_*; RT_NONE: the background's color
    const char* name = "";   // in text
    const char* label = "";  // in the panel
    const char* help = "";
    std::vector<Key> keys;  // members of SkyValues. An alias is read, but has no effect on this kind
};

// The first is that of RT_NONE, the others are in the order of RT_SKY_CONSTANT, ...
const std::vector<SkyKind>& sky_kinds();
const SkyKind& sky_kind_of(rt_u32 kind);
const rt_primitive_kind* sky_kind_for_plugins(rt_u32 kind);  // NULL: there is no such kind

bool same_sky(const SkyValues& a, const SkyValues& b);

}  // namespace clarity
