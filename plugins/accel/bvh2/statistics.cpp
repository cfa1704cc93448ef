#include "statistics.hpp"

#include <algorithm>

#include "rt_plugin.hpp"

namespace bvh2 {
namespace {

double area(const float box[6]) {
    const double x = double{box[3]} - box[0], y = double{box[4]} - box[1], z = double{box[5]} - box[2];
    return 2 * (x * y + y * z + z * x);
}

double root_area(const bvh2_node& root) {
    float box[6];
    const bool one = root.child1 == BVH2_MAKE_LEAF(0u, 0u);
    for (int i = 0; i < 3; ++i) {
        box[i] = one ? root.box0[i] : std::min(root.box0[i], root.box1[i]);
        box[3 + i] = one ? root.box0[3 + i] : std::max(root.box0[3 + i], root.box1[3 + i]);
    }
    return area(box);
}

struct Part {
    uint32_t group;
    rt_u32 begin, end;
    uint64_t leaves = 0;
    double node_area = 0, primitive_area = 0;
    void add(const float box[6], rt_u32 child) {
        if (!(child & BVH2_LEAF)) {
            node_area += area(box);
        } else if (BVH2_LEAF_COUNT(child) > 0) {
            ++leaves;
            primitive_area += area(box) * BVH2_LEAF_COUNT(child);
        }
    }
};

}  // namespace

Statistics measure(const rt_host* host, const clarity::bvh::Rules& rules, const bvh2_node* nodes, rt_u32 node_count,
                   const std::vector<rt_u32>& roots, const rt_group* groups) {
    constexpr rt_u32 kPart = 8192;
    std::vector<Part> parts;
    for (uint32_t g = 0; g < roots.size(); ++g) {
        const rt_u32 end = g + 1 < roots.size() ? roots[g + 1] : node_count;
        for (rt_u32 at = roots[g]; at < end; at = parts.back().end) parts.push_back({g, at, std::min(at + kPart, end)});
    }
    rt::parallel_for(host, static_cast<rt_u32>(parts.size()), [&](uint32_t p) {
        for (rt_u32 i = parts[p].begin; i < parts[p].end; ++i) {
            parts[p].add(nodes[i].box0, nodes[i].child0);
            parts[p].add(nodes[i].box1, nodes[i].child1);
        }
    });

    Statistics result;
    double cost = 0, primitives = 0;
    size_t at = 0;
    for (uint32_t g = 0; g < roots.size(); ++g) {
        const double whole = root_area(nodes[roots[g]]);
        double node_area = whole, primitive_area = 0;
        for (; at < parts.size() && parts[at].group == g; ++at) {
            result.leaves += parts[at].leaves;
            node_area += parts[at].node_area;
            primitive_area += parts[at].primitive_area;
        }
        if (!(whole > 0)) continue;  // no ray hits a point or a line
        cost += groups[g].count * (rules.traversal_cost * node_area + rules.intersection_cost * primitive_area) / whole;
        primitives += groups[g].count;
    }
    result.sah_cost = primitives > 0 ? cost / primitives : 0;
    return result;
}

}  // namespace bvh2
