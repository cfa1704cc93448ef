#define PARAMS \
    { "split", "Split", "how", RT_PARAM_ENUM, RT_EFFECT_REBUILD, 0, 2, 0, choices }
#include "sound.h"
PLUGIN
