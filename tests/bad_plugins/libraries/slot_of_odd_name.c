#define SLOTS \
    { "nodes; }", "uint", 4, 0 }
#include "sound.h"
PLUGIN
