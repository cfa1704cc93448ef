#define TREE NULL, "BVH 2", NULL
#include "sound.h"
PLUGIN
