#define TRAITS 0, 1, 1, 7
#include "sound.h"
PLUGIN
