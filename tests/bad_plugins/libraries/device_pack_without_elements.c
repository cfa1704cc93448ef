#define EXTENSIONS extensions_of_it
#include "sound.h"
#include "rt_device.h"
static int32_t pack(const rt_host* host, const rt_device_plan* plan, const rt_device_input* in, const rt_device_topology* topology,
                    const rt_device_tree* tree, const rt_device_output* out) {
    (void)plan, (void)in, (void)topology, (void)tree, (void)out;
    return host->fail(host->ctx, "the test plugin plans nothing");
}
static const rt_device_build build_of_it = {sizeof(rt_device_build), 0, {"sound_build.cl", " "}, NULL, NULL, pack, NULL, NULL};
static const rt_extension extensions_of_it[] = {{RT_DEVICE_BUILD, RT_DEVICE_BUILD_VERSION, sizeof build_of_it, &build_of_it}, {NULL, 0, 0, NULL}};
PLUGIN
