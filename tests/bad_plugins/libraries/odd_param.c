#define PARAM_BYTES (sizeof(rt_param) + 1)
#include "sound.h"
PLUGIN
