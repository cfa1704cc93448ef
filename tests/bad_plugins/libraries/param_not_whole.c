#define PARAMS \
    { "leaf", "Leaf", "primitives", RT_PARAM_INT, RT_EFFECT_REBUILD, 1, 16, 2.5, NULL }
#include "sound.h"
PLUGIN
