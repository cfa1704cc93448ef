#define ID "Sound-1"
#include "sound.h"
PLUGIN
