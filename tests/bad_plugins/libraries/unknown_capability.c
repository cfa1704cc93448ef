/* Has a capability of a later SDK: no defect, this host does without it. */
#define ID "unknown_capability"
#define TRAITS RT_TRAVERSES_STREAMS | 0x80000000u, 1, 1, RT_RAY_COST_LOGARITHMIC
#include "sound.h"
PLUGIN
