#define PARAMS \
    { "leaf", "Leaf", NULL, RT_PARAM_INT, RT_EFFECT_REBUILD, 1, 16, 4, NULL }
#include "sound.h"
PLUGIN
