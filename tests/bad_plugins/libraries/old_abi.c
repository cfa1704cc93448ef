#define ABI 0
#include "sound.h"
PLUGIN
