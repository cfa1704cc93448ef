#define DIGEST (RT_TYPES_DIGEST ^ 1u)
#include "sound.h"
PLUGIN
