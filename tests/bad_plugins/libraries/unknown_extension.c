/* Has extensions that this host does not know, and a later version of one that it may know: no defect, the host ignores them. */
#define ID "unknown_extension"
#define EXTENSIONS extensions_of_it
#include "sound.h"
static const rt_u32 data[] = {1, 2};
static const rt_extension extensions_of_it[] = {
    {"org.example.paint", 1, sizeof data, data}, {"refit", 1000000, sizeof data, data}, {NULL, 0, 0, NULL}};
PLUGIN
