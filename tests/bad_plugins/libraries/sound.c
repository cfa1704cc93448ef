#include "sound.h"
PLUGIN
