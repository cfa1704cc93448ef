/* rt_plugin_v1 as a function, as plugins of other programs do it. */
#include "sound.h"
RT_EXPORT const void* plugin_entry(void) __asm__("rt_plugin_v1");
const void* plugin_entry(void) {
    return &accel;
}
