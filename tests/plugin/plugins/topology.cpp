// A structure that builds only a tree, for the layout that LAYOUT names. Its id is "tree_of_" and that name.
#include "rt_plugin.hpp"

static int32_t build(const rt_host* host, const rt_build_input*, const rt_topology_output*) {
    return host->fail(host->ctx, "the test plugin builds nothing");
}

static constexpr rt_accel kAccel = rt::topology(LAYOUT, build, rt::Traits());

const rt_plugin rt_plugin_v1 = rt::accel_plugin("tree_of_" LAYOUT, "A tree without nodes", "1.0", nullptr, kAccel);
