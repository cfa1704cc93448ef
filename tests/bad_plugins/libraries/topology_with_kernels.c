#define TREE NULL, "bvh2", topology
#include "rt_plugin.h"
static int32_t topology(const rt_host* host, const rt_build_input* in, const rt_topology_output* out) {
    (void)in, (void)out;
    return host->fail(host->ctx, "the test plugin builds nothing");
}
#include "sound.h"
PLUGIN
