#define TRAVERSE "sound.cl", NULL
#include "sound.h"
PLUGIN
