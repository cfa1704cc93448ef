#define EXTENSIONS extensions_of_it
#include "sound.h"
#include "rt_device.h"
static const rt_device_build build_of_it = {sizeof(rt_device_build), 0, {"sound_build.cl", " "}, NULL, NULL, NULL, NULL, NULL};
static const rt_extension extensions_of_it[] = {{RT_DEVICE_BUILD, RT_DEVICE_BUILD_VERSION, sizeof build_of_it, &build_of_it}, {NULL, 0, 0, NULL}};
PLUGIN
