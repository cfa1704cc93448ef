#define SLOT_BYTES (sizeof(rt_slot) - 8)
#include "sound.h"
PLUGIN
