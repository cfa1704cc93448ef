#define TRAITS 0, -1, 1, RT_RAY_COST_LOGARITHMIC
#include "sound.h"
PLUGIN
