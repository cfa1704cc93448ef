#define EXTENSIONS extensions_of_it
#define EXTENSION_BYTES 8
#include "sound.h"
static const rt_extension extensions_of_it[] = {{NULL, 0, 0, NULL}};
PLUGIN
