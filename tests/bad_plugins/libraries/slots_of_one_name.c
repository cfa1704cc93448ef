#define SLOTS                     \
    {"sound_nodes", "uint", 4}, { \
        "sound_nodes", "float", 4 \
    }
#include "sound.h"
PLUGIN
