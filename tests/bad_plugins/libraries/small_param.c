#define PARAM_BYTES (sizeof(rt_param) - 8)
#include "sound.h"
PLUGIN
