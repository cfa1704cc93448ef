#define SLOTS \
    { "nodes; }", "uint", 4 }
#include "sound.h"
PLUGIN
