#define EXTENSIONS extensions_of_it
#include "sound.h"
#define FOUR {"a", 1, 0, NULL}, {"b", 1, 0, NULL}, {"c", 1, 0, NULL}, {"d", 1, 0, NULL}
#define SIXTEEN FOUR, FOUR, FOUR, FOUR
static const rt_extension extensions_of_it[] = {SIXTEEN, SIXTEEN, SIXTEEN, SIXTEEN, SIXTEEN};
PLUGIN
