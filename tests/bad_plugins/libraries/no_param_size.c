#define PARAM_BYTES 0
#include "sound.h"
PLUGIN
