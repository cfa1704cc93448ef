// bvh2.cpp -- binary bounding volume hierarchy by the binned surface area heuristic: the plugin's table, and its entry.
//
// Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies". 64 bytes a node, at most one node less than there
// are primitives; the traversal's stack is BVH2_STACK, measured. Good at everything that does not move; weak where large and
// small primitives overlap (there, spatial splits would help).
#include <cstdio>
#include <exception>

#include "builder.hpp"
#include "plugin.hpp"

namespace bvh2 {
namespace {

enum Param { kMaxLeaf, kBins, kTraversalCost, kIntersectionCost, kParamCount };
const rt_param kParams[kParamCount] = {
    {"max_leaf", "Max leaf size", "primitives in a leaf, at most; fewer where the heuristic finds that cheaper", RT_PARAM_INT,
     RT_EFFECT_REBUILD, 1, BVH2_LEAF_MAX, 4, nullptr},
    {"bins", "Bins", "slices per axis in which split planes are sought; more: slower to build, slightly better", RT_PARAM_INT,
     RT_EFFECT_REBUILD, 2, kMaxBins, 16, nullptr},
    {"traversal_cost", "Traversal cost", "what a node costs a ray, relative to the intersection cost", RT_PARAM_FLOAT,
     RT_EFFECT_REBUILD, 0.01, 100, 1, nullptr},
    {"intersection_cost", "Intersection cost", "what a primitive costs a ray, relative to the traversal cost", RT_PARAM_FLOAT,
     RT_EFFECT_REBUILD, 0.01, 100, 1, nullptr},
};

// The text of an embedded file by its name.
constexpr rt_cl_file kTexts[] = {
#include "bvh2.inc"
};
constexpr bool same(const char* a, const char* b) {
    while (*a && *a == *b) ++a, ++b;
    return *a == *b;
}
constexpr rt_cl_file text(const char* name) {
    for (const rt_cl_file& file : kTexts)
        if (same(file.name, name)) return file;
    return {name, nullptr};
}
static_assert(text("bvh2.cl").text && text("bvh2_types.h").text, "both files are embedded");

const rt_slot kSlots[] = {{"bvh2_nodes", "bvh2_node", sizeof(bvh2_node)}};
static_assert(sizeof(bvh2_node) == 64, "a node is a cache line");
const rt_accel kAccel = {sizeof(rt_accel), 1, kSlots, text("bvh2_types.h"), text("bvh2.cl"), build, levels, nullptr};

}  // namespace

int32_t build(const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
    uint64_t count = 0;
    for (uint32_t g = 0; g < input->group_count; ++g) count += input->groups[g].count;
    char why[160];
    if (count >= Builder::kMaxPrimitives) {
        std::snprintf(why, sizeof why,
                      "bvh2 holds %llu primitives at most, the scene has %llu: instance meshes, or leave some out",
                      static_cast<unsigned long long>(Builder::kMaxPrimitives - 1), static_cast<unsigned long long>(count));
        return host->fail(host->ctx, why);
    }
    const Rules rules{static_cast<uint32_t>(input->params[kMaxLeaf]), static_cast<uint32_t>(input->params[kBins]),
                      static_cast<float>(input->params[kTraversalCost]), static_cast<float>(input->params[kIntersectionCost])};
    try {
        return Builder(host, *input, rules, count).run(*out);
    } catch (const std::bad_alloc&) {
        std::snprintf(why, sizeof why, "bvh2 could not get the %.1f GiB that it needs to build a tree of %llu primitives",
                      static_cast<double>(count) * Builder::kBytesPerPrimitive / (1 << 30),
                      static_cast<unsigned long long>(count));
    } catch (const std::exception& e) {
        std::snprintf(why, sizeof why, "bvh2 could not build: %s", e.what());
    }
    return host->fail(host->ctx, why);
}

}  // namespace bvh2

extern "C" const rt_plugin rt_plugin_v1 = {
    RT_ABI_VERSION,  sizeof(rt_plugin),
    RT_TYPES_DIGEST, bvh2::kParamCount,
    "bvh2",          "Binary BVH (binned SAH)",
    "1.0",           "Wald 2007, On fast Construction of SAH-based Bounding Volume Hierarchies",
    bvh2::kParams,   &bvh2::kAccel,
    nullptr};
