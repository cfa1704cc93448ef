// slow_median.cpp -- a builder of median splits that takes a while, so that tests can do things while a structure is built.
#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

#include "rt_plugin.hpp"

namespace {

constexpr int kSlowMs = 120;

struct Splitter {
    rt_topology_node* nodes;
    rt_u32* refs;
    rt_u32 node = 0, ref = 0;
    rt_u32 split(rt_prim* begin, rt_prim* end) {
        const rt_u32 at = node++, count = rt_u32(end - begin);
        rt_topology_node n{{3e38f, 3e38f, 3e38f}, ref, {-3e38f, -3e38f, -3e38f}, RT_TOPOLOGY_LEAF | count};
        for (const rt_prim* p = begin; p < end; ++p)
            for (int k = 0; k < 3; ++k) {
                n.lo[k] = std::min(n.lo[k], p->lo[k]);
                n.hi[k] = std::max(n.hi[k], p->hi[k]);
            }
        if (count <= 4) {
            for (const rt_prim* p = begin; p < end; ++p) refs[ref++] = p->ref;
        } else {
            n.left = split(begin, begin + count / 2);
            n.right = split(begin + count / 2, end);
        }
        nodes[at] = n;
        return at;
    }
};

int32_t build(const rt_host* host, const rt_build_input* in, const rt_topology_output* out) {
    for (int ms = 0; ms < kSlowMs; ms += 10) {
        rt::progress(host, float(ms) / kSlowMs);
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    uint64_t count = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) count += in->groups[g].count;
    Splitter tree{rt::nodes(out, 2 * count), rt::refs(out, count)};
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        const rt_prim* const first = in->prims + in->groups[g].first;
        std::vector<rt_prim> prims(first, first + in->groups[g].count);
        rt::root(out, g, prims.empty() ? RT_NONE : tree.split(prims.data(), prims.data() + prims.size()));
    }
    return RT_OK;
}

constexpr rt_accel kAccel = rt::topology("bvh2", rt::guarded<build>, rt::Traits());

}  // namespace

const rt_plugin rt_plugin_v1 = rt::accel_plugin("slow_median", "Median splits, slowly", "1.0.0", nullptr, kAccel);
