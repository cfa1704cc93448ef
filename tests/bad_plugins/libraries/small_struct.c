#define PLUGIN_BYTES (sizeof(rt_plugin) - 8)
#include "sound.h"
PLUGIN
