#define ABI 1
#include "sound.h"
PLUGIN
