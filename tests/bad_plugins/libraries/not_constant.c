/* As if C++ computed rt_plugin_v1 at start-up: the file contains only zeros. */
#include "sound.h"
const rt_plugin rt_plugin_v1 = {0};
