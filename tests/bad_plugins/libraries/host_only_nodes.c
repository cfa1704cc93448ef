#define SLOTS \
    { "sound_nodes", NULL, 4, RT_SLOT_HOST_ONLY }
#include "sound.h"
PLUGIN
