/* rt_plugin_v1 is a function, as in plugins of other programs. */
#include "sound.h"
RT_EXPORT const void* plugin_entry(void) __asm__("rt_plugin_v1");
const void* plugin_entry(void) {
    return &accel;
}
