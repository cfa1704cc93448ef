#define EXTENSIONS extensions_of_it
#include "sound.h"
#include "rt_refit.h"
static const rt_refit refit_of_it = {sizeof(rt_refit), 0, NULL};
static const rt_extension extensions_of_it[] = {{RT_REFIT, RT_REFIT_VERSION, sizeof(rt_refit), &refit_of_it}, {NULL, 0, 0, NULL}};
PLUGIN
