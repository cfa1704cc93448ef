#define PARAMS \
    { "leaf", "Leaf", "primitives", 9, RT_EFFECT_REBUILD, 1, 16, 4, NULL }
#include "sound.h"
PLUGIN
