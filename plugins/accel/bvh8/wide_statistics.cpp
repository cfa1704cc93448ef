#include "wide_statistics.hpp"

#include <algorithm>

#include "node_bounds.hpp"
#include "rt_plugin.hpp"

namespace bvh8 {
namespace {

double area(const float box[6]) {
    const double x = double{box[3]} - box[0], y = double{box[4]} - box[1], z = double{box[5]} - box[2];
    return 2 * (x * y + y * z + z * x);
}

struct Part {
    rt_u32 group, begin, end;
    uint64_t leaves = 0, children = 0;
    double node_area = 0, primitive_area = 0;
};

}  // namespace

Statistics measure(const rt_host* host, const WideTree& tree, const Costs& costs, const rt_group* groups) {
    constexpr rt_u32 kPart = 4096;
    const std::vector<rt_u32>& roots = tree.roots();
    std::vector<Part> parts;
    for (rt_u32 g = 0; g < roots.size(); ++g) {
        const rt_u32 end = g + 1 < roots.size() ? roots[g + 1] : tree.node_count();
        for (rt_u32 at = roots[g]; at < end; at = parts.back().end) parts.push_back({g, at, std::min(at + kPart, end)});
    }
    rt::parallel_for(host, static_cast<rt_u32>(parts.size()), [&](rt_u32 p) {
        Part& part = parts[p];
        for (rt_u32 n = part.begin; n < part.end; ++n)
            each_child(tree.nodes()[n], [&](const float box[6], rt_u32 child) {
                ++part.children;
                if (!(child & BVH8_LEAF)) {
                    part.node_area += area(box);
                    return;
                }
                ++part.leaves;
                part.primitive_area += area(box) * BVH8_LEAF_COUNT(child);
            });
    });

    Statistics result;
    double cost = 0, primitives = 0;
    size_t at = 0;
    for (rt_u32 g = 0; g < roots.size(); ++g) {
        float box[6];
        const double whole = bounds(tree.nodes()[roots[g]], box) ? area(box) : 0;
        double node_area = whole, primitive_area = 0;
        for (; at < parts.size() && parts[at].group == g; ++at) {
            result.leaves += parts[at].leaves;
            result.children += parts[at].children;
            node_area += parts[at].node_area;
            primitive_area += parts[at].primitive_area;
        }
        if (!(whole > 0)) continue;  // no ray meets a point or a line
        cost += groups[g].count * (double{costs.node} * node_area + double{costs.primitive} * primitive_area) / whole;
        primitives += groups[g].count;
    }
    result.sah_cost = primitives > 0 ? cost / primitives : 0;
    return result;
}

}  // namespace bvh8
