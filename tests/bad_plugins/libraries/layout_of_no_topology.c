#define TREE NULL, "bvh2", NULL
#include "sound.h"
PLUGIN
