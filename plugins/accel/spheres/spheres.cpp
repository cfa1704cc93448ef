// spheres.cpp -- the structure of the thesis: a tree of bounding spheres for each mesh, and no tree above the meshes.
//
// A node takes 32 bytes, and the traversal needs no stack. The structure is quick to build, cheap to test and small. But
// spheres overlap more than boxes do, splitting by count ignores empty space, nodes are not visited in the order of distance,
// and every ray tests the root of every mesh.
#include <algorithm>
#include <vector>

#include "refit.hpp"
#include "sphere_tree.hpp"

namespace spheres {
namespace {

enum Param { kMaxLeaf, kMaxDepth, kTopLevel, kLoneSpheres };
constexpr rt_param kParams[] = {
    rt::int_param("max_leaf", "Max leaf size", "primitives at which parting stops", 1, 256, 4),
    rt::int_param("max_depth", "Max depth", "levels below a mesh's root at which parting stops, whatever is left", 0, 32, 32),
    rt::bool_param("top_level", "Tree above meshes", "also part the meshes into halves; the thesis tries them one by one",
                   false),
    rt::bool_param(
        "lone_spheres", "Lone spheres",
        "analytic spheres are tried one by one, as in the thesis, where each is its own volume; else they get a tree. "
        "Without effect under a tree above meshes",
        false),
};

// The primitives of one mesh within a group.
struct Run {
    uint32_t first, count;
    Box box;
    bool lone;  // of spheres that rays test one by one, without a tree
};

// The tree of a mesh, the index of its first node, and the level of its root.
struct Job {
    Run run;
    uint32_t at, level;
};

// Lays out the nodes before they are built: the heads of the groups, the nodes above the meshes, and the trees of the meshes.
class Plan {
 public:
    Plan(const rt_host* host, const Rules& rules, bool top_level) : host_(host), rules_(rules), top_level_(top_level) {}

    std::vector<rt_u32> roots;
    std::vector<Job> jobs;
    std::vector<Run> lone;
    std::vector<std::pair<uint32_t, spheres_node>> ready;  // index and node
    uint64_t size = 0;

    void add_group(std::vector<Run> runs) {
        const uint64_t head = size++;
        roots.push_back(static_cast<rt_u32>(head));
        Box box;
        for (const Run& run : runs) box.add(run.box);
        if (top_level_ && !runs.empty())
            add_halves(runs.data(), runs.size(), 0);
        else
            for (const Run& run : runs) add_run(run, 0);
        spheres_node node{};
        if (!runs.empty()) set_sphere(node, box);
        finish(node, head);
    }

 private:
    void add_run(const Run& run, uint32_t level) {
        if (run.lone) {
            add_lone(run, level);
            return;
        }
        jobs.push_back({run, static_cast<uint32_t>(size), level});
        size += tree_size(rules_, run.count);
    }

    // Adds one leaf that every ray enters.
    void add_lone(const Run& run, uint32_t level) {
        const uint64_t place = size++;
        spheres_node node{};
        node.radius = kEverywhere;
        node.level = level;
        node.first = run.first;
        node.count = run.count;
        finish(node, place);
        lone.push_back(run);
    }

    void add_halves(Run* runs, size_t count, uint32_t level) {
        if (count == 1) {
            add_run(*runs, level);
            return;
        }
        Box box;
        for (size_t i = 0; i < count; ++i) box.add(runs[i].box);
        const int axis = box.longest_axis();
        std::nth_element(runs, runs + count / 2, runs + count,
                         [axis](const Run& a, const Run& b) { return a.box.center(axis) < b.box.center(axis); });
        const uint64_t place = size++;
        add_halves(runs, count / 2, level + 1);
        add_halves(runs + count / 2, count - count / 2, level + 1);
        spheres_node node{};
        set_sphere(node, box);
        node.level = level;
        finish(node, place);
    }

    void finish(spheres_node& node, uint64_t place) {
        if (size > RT_NONE) throw rt::fail(host_, "needs more than 2^32 nodes: raise max_leaf");
        node.skip = static_cast<rt_u32>(size);
        ready.emplace_back(static_cast<uint32_t>(place), node);
    }

    const rt_host* host_;
    const Rules rules_;
    const bool top_level_;
};

// Copies the primitives of a group to `items`, and returns its meshes. lone: rays test spheres one by one, without a tree.
std::vector<Run> gather(const rt_build_input& input, const rt_group& group, bool lone, std::vector<Item>& items) {
    std::vector<Run> runs;
    for (rt_u32 i = group.first; i < group.first + group.count; ++i) {
        const rt_prim& prim = input.prims[i];
        if (i == group.first || prim.mesh != input.prims[i - 1].mesh)
            runs.push_back({static_cast<uint32_t>(items.size()), 0, {}, lone && RT_REF_KIND(prim.ref) == RT_REF_SPHERE});
        items.push_back(make_item(prim));
        ++runs.back().count;
        runs.back().box.add(items.back().box);
    }
    return runs;
}

int32_t build(const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
    const double* const params = input->params;
    const Rules rules{static_cast<uint32_t>(params[kMaxLeaf]), static_cast<uint32_t>(params[kMaxDepth])};
    uint64_t count = 0;
    for (rt_u32 g = 0; g < input->group_count; ++g) count += input->groups[g].count;
    if (count > RT_REF_INDEX_MAX) throw rt::fail(host, "holds 2^28 - 1 primitives at most: instance meshes, or leave some out");

    std::vector<Item> items;
    items.reserve(count);
    const bool top_level = params[kTopLevel] != 0, lone = params[kLoneSpheres] != 0 && !top_level;
    Plan plan(host, rules, top_level);
    for (rt_u32 g = 0; g < input->group_count; ++g) plan.add_group(gather(*input, input->groups[g], lone, items));
    rt::progress(host, 0.1f);

    auto* const nodes = rt::alloc<spheres_node>(out, 0, plan.size);
    rt_u32* const leaves = rt::leaves(out, count);
    for (const auto& [place, node] : plan.ready) nodes[place] = node;
    for (const Run& run : plan.lone)
        for (uint32_t i = run.first; i < run.first + run.count; ++i) leaves[i] = items[i].ref;
    const Forest forest{host, rules, items.data(), nodes};
    rt::parallel_for(host, static_cast<rt_u32>(plan.jobs.size()), [&](rt_u32 j) {
        const Job& job = plan.jobs[j];
        build_tree(forest, job.run.first, job.run.count, job.at, job.level);
        for (uint32_t i = job.run.first; i < job.run.first + job.run.count; ++i) leaves[i] = items[i].ref;
    });
    for (rt_u32 g = 0; g < input->group_count; ++g) rt::root(out, g, plan.roots[g]);

    uint64_t leaf_count = 0;
    uint32_t depth = 0;
    for (uint64_t i = 0; i < plan.size; ++i)
        if (nodes[i].count > 0) {
            ++leaf_count;
            depth = std::max(depth, nodes[i].level + 1);
        }
    rt::stat(out, "nodes", static_cast<double>(plan.size));
    rt::stat(out, "leaves", static_cast<double>(leaf_count));
    rt::stat(out, "depth", depth);
    rt::stat(out, "meshes", static_cast<double>(plan.jobs.size()));
    return RT_OK;
}

int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    if (group >= built->group_count) throw rt::fail(host, "was asked for the levels of a group that the scene does not have");
    const auto* const nodes = static_cast<const spheres_node*>(built->slots[0]);
    const rt_u32 head = built->roots[group];
    for (rt_u32 i = head + 1; i < nodes[head].skip; ++i)
        if (nodes[i].radius < kEverywhere && (level == RT_LEVEL_BOTTOM ? nodes[i].count > 0 : nodes[i].level == level))
            sink->sphere(sink->ctx, nodes[i].center, nodes[i].radius);
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "spheres.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<spheres_node>("spheres_nodes", "spheres_node")};
constexpr rt_accel kAccel = rt::accel(kSlots, rt::file(kFiles, "spheres_types.h"), rt::file(kFiles, "spheres.cl"),
                                      rt::guarded<build>, rt::guarded<levels>, rt::Traits().merit(0.3f, 0));
constexpr rt_refit kRefit = rt::refit(rt::guarded<refit>);
constexpr rt_extension kExtensions[] = {rt::extension(kRefit), rt::kNoMoreExtensions};
static_assert(sizeof(spheres_node) == 32, "two nodes to a cache line");
static_assert(kAccel.types.text && kAccel.traverse.text, "the kernel files are embedded");

}  // namespace
}  // namespace spheres

const rt_plugin rt_plugin_v1 = rt::with_extensions(
    rt::accel_plugin("spheres", "Bounding spheres (thesis)", "1.0.0", nullptr, spheres::kParams, spheres::kAccel),
    spheres::kExtensions);
