#define PARAMS \
    { "split", "Split", "how", RT_PARAM_ENUM, RT_EFFECT_REBUILD, 0, 0, 0, no_choices }
#include "sound.h"
PLUGIN
