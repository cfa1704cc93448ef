#define SLOTS \
    { "sound_nodes", NULL, 4 }
#include "sound.h"
PLUGIN
