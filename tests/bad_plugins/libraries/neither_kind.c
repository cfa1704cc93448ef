#define ACCEL NULL
#include "sound.h"
PLUGIN
