/* What the file holds where C++ computes rt_plugin_v1 at start: nothing yet. */
#include "sound.h"
const rt_plugin rt_plugin_v1 = {0, 0, 0, 0, NULL, NULL, NULL, NULL, NULL, NULL, NULL};
