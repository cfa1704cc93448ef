#define CONTRACT 0
#include "sound.h"
PLUGIN
