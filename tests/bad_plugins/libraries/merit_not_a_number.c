#define TRAITS 0, 1, __builtin_nanf(""), RT_RAY_COST_LOGARITHMIC
#include "sound.h"
PLUGIN
