/* As from a later SDK, in which rt_plugin has one more field at its end. This is no defect: the host accepts it. */
#include "sound.h"
struct grown {
    rt_plugin known;
    const char* later;
};
RT_EXPORT extern const struct grown grown_plugin __asm__("rt_plugin_v1");
const struct grown grown_plugin = {
    {ABI, sizeof(struct grown), DIGEST, PARAM_COUNT, "grown", NAME, "1.0", NULL, params, ACCEL, IMPORTER}, "later"};
