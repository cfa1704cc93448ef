/* Calls a function which no library defines. */
#define ACCEL &calling
#include "sound.h"
void sound_function_that_nobody_has(void);
static int32_t call(const rt_host* host, const rt_build_input* in, const rt_build_output* out) {
    sound_function_that_nobody_has();
    return build(host, in, out);
}
static const rt_accel calling = {sizeof(rt_accel), CONTRACT, 1, SLOT_BYTES, slots, {NULL, NULL}, {TRAVERSE},
                                 call, NULL, TREE, TRAITS};
PLUGIN
