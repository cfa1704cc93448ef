#define BUILD NULL
#include "sound.h"
PLUGIN
