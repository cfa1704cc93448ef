#define SLOTS \
    { "sound_nodes", "uint", 0, 0 }
#include "sound.h"
PLUGIN
