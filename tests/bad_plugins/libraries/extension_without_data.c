#define EXTENSIONS extensions_of_it
#include "sound.h"
static const rt_extension extensions_of_it[] = {{"refit", 1, 16, NULL}, {NULL, 0, 0, NULL}};
PLUGIN
