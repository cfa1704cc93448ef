/* sound_crashes.c -- another build of the sound plugin of bad_plugins, whose builder crashes. */
#include "rt_plugin.h"

static int32_t crash(const rt_host* host, const rt_build_input* in, const rt_build_output* out) {
    (void)host, (void)in, (void)out;
    *(volatile int*)16 = 1;
    return RT_OK;
}
#define BUILD crash
#define DEFECT_sound
#include "../../bad_plugins/libraries/defects.c"
