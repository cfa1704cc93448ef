#include "sound.h"
RT_EXPORT extern const rt_plugin rt_plugin_v0;
const rt_plugin rt_plugin_v0 = {ABI, PLUGIN_BYTES, DIGEST, PARAM_COUNT, ID, NAME, "1.0",
                                 NULL, params, ACCEL, IMPORTER, EXTENSIONS, PARAM_BYTES, EXTENSION_BYTES, NULL};
