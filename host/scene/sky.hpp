// sky.hpp -- what lies beyond a scene and lights it, for a path tracer.
#pragma once
#include <string>
#include <vector>

#include "base/members.hpp"
#include "rt_types.h"
#include "scene/shared_array.hpp"

namespace clarity {

// Plain data. kind: RT_SKY_*; RT_NONE: the file says nothing, and the sky has the background's color.
struct SkyValues {
    rt_u32 kind = RT_NONE;
    rt_u32 width = 0, height = 0;  // of the picture
    rt_u32 hidden = 0;             // not 0: camera rays see the background instead
    float rotate_deg = 0;          // about +Y, counter-clockwise seen from above
    float strength = 1;            // factor of all that follows
    rt_f32 color[3] = {1, 1, 1};   // radiance; of a gradient at the zenith
    rt_f32 horizon[3] = {}, ground[3] = {};
};

struct Sky {
    SkyValues values;
    std::string file;           // of the picture, as the scene's file names it
    SharedArray<float> texels;  // of the picture: linear RGB, radiance, top row first
    CLARITY_MEMBERS(values, file, texels);
};

}  // namespace clarity
