#define NAME "sound\033[2J"
#include "sound.h"
PLUGIN
