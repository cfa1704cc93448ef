#define ACCEL_BYTES (sizeof(rt_accel) - 8)
#include "sound.h"
PLUGIN
