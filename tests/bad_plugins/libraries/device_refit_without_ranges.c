#define EXTENSIONS extensions_of_it
#include "sound.h"
#include "rt_device.h"
static int32_t refit(const rt_host* host, const rt_device_plan* plan, const rt_device_tree* tree, rt_u32 blocks, rt_u32 costs,
                     const double* params) {
    (void)plan, (void)tree, (void)blocks, (void)costs, (void)params;
    return host->fail(host->ctx, "the test plugin plans nothing");
}
static const rt_device_build build_of_it = {sizeof(rt_device_build), 0, {"sound_build.cl", " "}, NULL, NULL, NULL, NULL, refit};
static const rt_extension extensions_of_it[] = {{RT_DEVICE_BUILD, RT_DEVICE_BUILD_VERSION, sizeof build_of_it, &build_of_it}, {NULL, 0, 0, NULL}};
PLUGIN
