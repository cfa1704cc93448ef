// median.cpp -- a plugin of ABI version 2, kept as it was when it was frozen: do not edit it. Median splits, traced by bvh2.
#include <algorithm>
#include <vector>

#include "rt_plugin.hpp"

struct Splitter {
    rt_topology_node* nodes;
    rt_u32 *refs, node = 0, ref = 0;
    rt_u32 split(rt_prim* begin, rt_prim* end) {
        const rt_u32 at = node++, count = rt_u32(end - begin);
        rt_topology_node n{{3e38f, 3e38f, 3e38f}, ref, {-3e38f, -3e38f, -3e38f}, RT_TOPOLOGY_LEAF | count};
        for (const rt_prim* p = begin; p < end; ++p)
            for (int k = 0; k < 3; ++k) n.lo[k] = std::min(n.lo[k], p->lo[k]), n.hi[k] = std::max(n.hi[k], p->hi[k]);
        if (count <= 4) {
            for (const rt_prim* p = begin; p < end; ++p) refs[ref++] = p->ref;
        } else {
            int axis = 0;
            for (int k = 1; k < 3; ++k) axis = n.hi[k] - n.lo[k] > n.hi[axis] - n.lo[axis] ? k : axis;
            const auto before = [=](const rt_prim& a, const rt_prim& b) {
                return a.lo[axis] + a.hi[axis] < b.lo[axis] + b.hi[axis];
            };
            std::nth_element(begin, begin + count / 2, end, before);
            n.left = split(begin, begin + count / 2), n.right = split(begin + count / 2, end);
        }
        return nodes[at] = n, at;
    }
};
static int32_t build(const rt_host*, const rt_build_input* in, const rt_topology_output* out) {
    uint64_t count = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) count += in->groups[g].count;
    Splitter tree{rt::nodes(out, 2 * count), rt::refs(out, count)};
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        std::vector<rt_prim> p(in->prims + in->groups[g].first, in->prims + in->groups[g].first + in->groups[g].count);
        rt::root(out, g, p.empty() ? RT_NONE : tree.split(p.data(), p.data() + p.size()));
    }
    return RT_OK;
}
static constexpr rt_accel kAccel = rt::topology("bvh2", rt::guarded<build>, rt::Traits());
const rt_plugin rt_plugin_v1 = rt::accel_plugin("frozen2_median", "Median splits of ABI 2", "1.0.0", nullptr, kAccel);
