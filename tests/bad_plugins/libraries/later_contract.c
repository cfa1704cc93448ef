#define CONTRACT (RT_KERNEL_CONTRACT + 1)
#include "sound.h"
PLUGIN
