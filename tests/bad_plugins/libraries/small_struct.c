#define PLUGIN_BYTES 80 /* of the first release of version 2: 88 */
#include "sound.h"
PLUGIN
