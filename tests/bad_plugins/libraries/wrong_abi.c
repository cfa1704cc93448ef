#define ABI (RT_ABI_VERSION + 1)
#include "sound.h"
PLUGIN
