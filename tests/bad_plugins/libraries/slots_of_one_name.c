#define SLOTS                        \
    {"sound_nodes", "uint", 4, 0}, { \
        "sound_nodes", "float", 4, 0 \
    }
#include "sound.h"
PLUGIN
