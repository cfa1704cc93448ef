#define SLOTS \
    { "sound_nodes", NULL, 4, 0 }
#include "sound.h"
PLUGIN
