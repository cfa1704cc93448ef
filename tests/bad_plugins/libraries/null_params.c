#include "sound.h"
const rt_plugin rt_plugin_v1 = {ABI,  PLUGIN_BYTES, DIGEST, 2,        ID,         NAME,        "1.0",
                                NULL, NULL,         ACCEL,  IMPORTER, EXTENSIONS, PARAM_BYTES, EXTENSION_BYTES, NULL};
