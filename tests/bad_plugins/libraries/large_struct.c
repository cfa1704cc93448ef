#define PLUGIN_BYTES (sizeof(rt_plugin) + 64) /* more than the library exports */
#include "sound.h"
PLUGIN
