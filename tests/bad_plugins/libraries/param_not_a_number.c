#define PARAMS \
    { "leaf", "Leaf", "share", RT_PARAM_FLOAT, RT_EFFECT_REBUILD, 0, 1, __builtin_nan(""), NULL }
#include "sound.h"
PLUGIN
