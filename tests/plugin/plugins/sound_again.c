/* sound_again.c -- another build of the sound plugin of bad_plugins, with one more parameter in front. */
#define PARAMS \
    { "depth", "Depth", "levels, at most", RT_PARAM_INT, RT_EFFECT_REBUILD, 1, 64, 32, NULL }, \
    { "max_leaf", "Max leaf size", "primitives in a leaf, at most", RT_PARAM_INT, RT_EFFECT_REBUILD, 1, 8, 4, NULL }
#define DEFECT_sound
#include "../../bad_plugins/libraries/defects.c"
