/* The symbol is defined but not exported. */
#include "sound.h"
__attribute__((visibility("hidden"))) extern const rt_plugin hidden_plugin __asm__("rt_plugin_v1");
const rt_plugin hidden_plugin = {ABI, PLUGIN_BYTES, DIGEST, PARAM_COUNT, ID, NAME, "1.0",
                                 NULL, params, ACCEL, IMPORTER, EXTENSIONS, PARAM_BYTES, EXTENSION_BYTES, NULL};
