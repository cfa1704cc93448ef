// spheres.cpp -- the structure of the thesis: a tree of bounding spheres for each mesh, and no tree above the meshes.
//
// A node takes 32 bytes, and the traversal needs no stack. The structure is quick to build, cheap to test and small. But
// spheres overlap more than boxes do, splitting by count ignores empty space, nodes are not visited in the order of distance,
// and every ray tests the root of every mesh. The thesis asked how other volumes perform: `volume` puts boxes (32 bytes) or
// oriented boxes (68 bytes) into the same tree.
#include <algorithm>
#include <cmath>
#include <vector>

#include "clarity_bvh/refit/refit.hpp"
#include "rt_cost.hpp"
#include "rt_plugin.hpp"
#include "sphere_tree.hpp"
#include "volumes.hpp"

namespace spheres {
namespace {

// The extension `refit` of spheres: new volumes for primitives that moved, in the same tree.

using namespace clarity::bvh;

Box box_of(const RefitBox& from) {
    Box box;
    alignas(16) float lo[4], hi[4];
    store(lo, from.lo);
    store(hi, from.hi);
    for (int k = 0; k < 3; ++k) {
        box.lo[k] = lo[k];
        box.hi[k] = hi[k];
    }
    return box;
}

// The primitives at positions from first to end in leaf order, as they are now.
class LeafTriangles final : public Triangles {
 public:
    LeafTriangles(const rt_packed_prim* leaves, rt_u32 count) : leaves_(leaves), count_(count) {}
    rt_u32 count() const override { return count_; }
    const rt_packed_prim* operator[](rt_u32 i) const override { return leaves_ + i; }

 private:
    const rt_packed_prim* const leaves_;
    const rt_u32 count_;
};

// A node's volume is that of its primitives or of their box, as in a build, so it does not grow from level to level. Oriented
// boxes keep their axes. Only nodes of nothing but triangles have such, and their positions stand together.
class SpheresRefit {
 public:
    static constexpr uint32_t kWidth = 2, kBlock = 256;

    SpheresRefit(spheres_node* nodes, const Volumes& volumes, const rt_refit_input* in)
        : nodes_(nodes), volumes_(volumes), in_(in) {}

    RefitUnit unit(uint32_t group) const {
        const float size = volumes_.size(in_->roots[group]);
        return RefitUnit(size > 0 ? 1 / size : 1);
    }
    template <class Each>
    void subtrees(uint32_t group, Each&& each) const {
        const uint32_t head = in_->roots[group];
        for (uint32_t at = head + 1; at < nodes_[head].link; at = end_of(at)) each(RefitSubtree{at, at + 1, end_of(at)});
    }
    uint32_t children(const RefitSubtree& tree, RefitSubtree out[kWidth]) const {
        if (nodes_[tree.node].count > 0) return 0;
        const uint32_t second = end_of(tree.first);
        out[0] = {tree.first, tree.first + 1, second};
        out[1] = {second, second + 1, tree.end};
        return 2;
    }
    uint64_t add_positions(uint32_t at, uint64_t& first, uint64_t& end) const {
        const spheres_node& node = nodes_[at];
        if (node.count == 0) return 0;
        first = std::min<uint64_t>(first, node.link);
        end = std::max<uint64_t>(end, uint64_t{node.link} + node.count);
        return node.count;
    }
    template <class NodeBox, class LeafBox>
    RefitBox update(uint32_t at, NodeBox&& node_box, LeafBox&& leaf_box, const RefitUnit& unit, RefitAreas& areas) const {
        const spheres_node& node = nodes_[at];
        RefitBox box;
        if (node.count > 0) {
            box = leaf_box(node.link, node.count);
        } else {
            box = node_box(at + 1);
            box.add(node_box(end_of(at + 1)));
        }
        if (!volumes_.is_everywhere(at)) put(at, box_of(box));
        const Vec4 area = unit.area(box);
        if (node.count > 0)
            areas.primitives = areas.primitives + area * splat(static_cast<float>(node.count));
        else
            areas.nodes = areas.nodes + area;
        return box;
    }
    void finish(uint32_t group, const RefitBox& box) const {
        const uint32_t head = in_->roots[group];
        if (nodes_[head].link > head + 1) volumes_.enclose(head, box_of(box));
    }

 private:
    uint32_t end_of(uint32_t at) const { return nodes_[at].count > 0 ? at + 1 : nodes_[at].link; }
    void put(uint32_t at, const Box& box) const {
        if (!volumes_.is_turned(at)) return volumes_.enclose(at, box);
        uint32_t first = at;
        while (nodes_[first].count == 0) ++first;
        const spheres_node& last = nodes_[end_of(at) - 1];
        const uint32_t begin = nodes_[first].link, end = last.link + last.count;
        volumes_.refit(at, box, LeafTriangles(in_->leaves + begin, end - begin));
    }

    spheres_node* const nodes_;
    const Volumes& volumes_;
    const rt_refit_input* const in_;
};

int32_t refit(const rt_host* host, const rt_refit_input* in, const rt_refit_output* out) {
    auto* const nodes = static_cast<spheres_node*>(out->slots[0]);
    const Volumes volumes(*static_cast<const rt_u32*>(out->slots[2]), nodes, static_cast<spheres_axes*>(out->slots[1]));
    SpheresRefit layout(nodes, volumes, in);
    Refit<SpheresRefit>(host, in, out, layout, {1, 1}).run();
    return RT_OK;
}

enum Param { kMaxLeaf, kMaxDepth, kTopLevel, kLoneSpheres, kVolume };
constexpr const char* kVolumes[] = {"sphere", "box", "oriented", nullptr};  // SPHERES_SPHERE, ...
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
    rt::enum_param(
        "volume", "Volume",
        "what bounds the primitives of a node: a sphere as in the thesis, a box, or a box that is turned as they lie", kVolumes,
        SPHERES_SPHERE),
};

// The primitives of one mesh within a group.
struct Run {
    uint32_t first, count;
    Box box;
    bool lone;  // of spheres that rays test one by one, without a tree
};

// The tree of a mesh, and the index of its first node.
struct Job {
    Run run;
    uint32_t at;
};

// A node that is above the trees of meshes, or the leaf of lone spheres.
struct Ready {
    uint32_t at;
    spheres_node node;
    Box box;
    bool everywhere;
};

// Lays out the nodes before they are built: the heads of the groups, the nodes above the meshes, and the trees of the meshes.
class Plan {
 public:
    Plan(const rt_host* host, const Rules& rules, bool top_level) : host_(host), rules_(rules), top_level_(top_level) {}

    std::vector<rt_u32> roots;
    std::vector<Job> jobs;
    std::vector<Run> lone;
    std::vector<Ready> ready;
    uint64_t size = 0;

    void add_group(std::vector<Run> runs) {
        const uint64_t head = size++;
        roots.push_back(static_cast<rt_u32>(head));
        Box box;
        for (const Run& run : runs) box.add(run.box);
        if (top_level_ && !runs.empty())
            add_halves(runs.data(), runs.size());
        else
            for (const Run& run : runs) add_run(run);
        if (runs.empty()) std::fill_n(box.lo, 3, 0.0f), std::fill_n(box.hi, 3, 0.0f);
        finish(head, box);
    }

 private:
    void add_run(const Run& run) {
        if (run.lone) {
            add_lone(run);
            return;
        }
        jobs.push_back({run, static_cast<uint32_t>(size)});
        size += tree_size(rules_, run.count);
    }

    // Adds one leaf that every ray enters.
    void add_lone(const Run& run) {
        const auto place = static_cast<uint32_t>(size++);
        ready.push_back({place, {{}, run.first, run.count}, {}, true});
        lone.push_back(run);
    }

    void add_halves(Run* runs, size_t count) {
        if (count == 1) {
            add_run(*runs);
            return;
        }
        Box box;
        for (size_t i = 0; i < count; ++i) box.add(runs[i].box);
        const int axis = box.longest_axis();
        std::nth_element(runs, runs + count / 2, runs + count,
                         [axis](const Run& a, const Run& b) { return a.box.center(axis) < b.box.center(axis); });
        const uint64_t place = size++;
        add_halves(runs, count / 2);
        add_halves(runs + count / 2, count - count / 2);
        finish(place, box);
    }

    // The node at `place`, which all nodes since then are below.
    void finish(uint64_t place, const Box& box) {
        if (size > RT_NONE) throw rt::fail(host_, "needs more than 2^32 nodes: raise max_leaf");
        ready.push_back({static_cast<uint32_t>(place), {{}, static_cast<rt_u32>(size), 0}, box, false});
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

// Tells the levels of nodes that are visited one after the other.
class Levels {
 public:
    explicit Levels(const spheres_node* nodes) : nodes_(nodes) {}
    uint32_t next(uint32_t at) {
        while (!ends_.empty() && ends_.back() <= at) ends_.pop_back();
        const auto level = static_cast<uint32_t>(ends_.size());
        if (nodes_[at].count == 0) ends_.push_back(nodes_[at].link);
        return level;
    }

 private:
    const spheres_node* const nodes_;
    std::vector<uint32_t> ends_;  // of the nodes above
};

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
    const auto kind = static_cast<rt_u32>(params[kVolume]);
    auto* const axes = rt::alloc<spheres_axes>(out, 1, kind == SPHERES_ORIENTED ? plan.size : 0);
    *rt::alloc<rt_u32>(out, 2, 1) = kind;
    const Volumes volumes(kind, nodes, axes);
    rt_u32* const leaves = rt::leaves(out, count);
    for (const Ready& one : plan.ready) {
        nodes[one.at] = one.node;
        if (one.everywhere)
            volumes.fill_space(one.at);
        else
            volumes.enclose(one.at, one.box);
    }
    for (const Run& run : plan.lone)
        for (uint32_t i = run.first; i < run.first + run.count; ++i) leaves[i] = items[i].ref;
    const Forest forest{host, rules, items.data(), input->geometry->triangles, nodes, volumes};
    rt::parallel_for(host, static_cast<rt_u32>(plan.jobs.size()), [&](rt_u32 j) {
        const Job& job = plan.jobs[j];
        build_tree(forest, job.run.first, job.run.count, job.at);
        for (uint32_t i = job.run.first; i < job.run.first + job.run.count; ++i) leaves[i] = items[i].ref;
    });
    for (rt_u32 g = 0; g < input->group_count; ++g) rt::root(out, g, plan.roots[g]);

    uint64_t leaf_count = 0, turned = 0;
    uint32_t depth = 0;
    Levels level_of(nodes);
    rt::ExpectedCost expected;
    for (uint32_t g = 0, first = 0; g < input->group_count; first += input->groups[g++].count) {
        Box box;
        for (uint32_t i = first; i < first + input->groups[g].count; ++i) box.add(items[i].box);
        const double whole = rt::surface_of(box.lo, box.hi);
        rt::Surfaces sums;
        for (uint32_t head = plan.roots[g], i = head + 1; i < nodes[head].link; ++i) {
            const uint32_t level = level_of.next(i);
            const double surface = std::min(volumes.surface(i), whole);
            turned += volumes.is_turned(i);
            sums.add_leaf(surface, nodes[i].count);
            if (nodes[i].count == 0) {
                sums.add_node(surface);
                continue;
            }
            ++leaf_count;
            depth = std::max(depth, level + 1);
        }
        expected.add_group(input->groups[g].count, whole, sums);
    }
    rt::define(out, "SPHERES_VOLUME", kind);
    rt::stat(out, "nodes", static_cast<double>(plan.size));
    rt::stat(out, "leaves", static_cast<double>(leaf_count));
    rt::stat(out, "depth", depth);
    expected.report(out);
    rt::stat(out, "meshes", static_cast<double>(plan.jobs.size()));
    if (kind == SPHERES_ORIENTED) rt::stat(out, "turned boxes", static_cast<double>(turned));
    return RT_OK;
}

void show(rt_u32 kind, const spheres_node& node, const spheres_axes* axes, const rt_volume_sink* sink) {
    const float* const v = node.volume;
    if (v[3] >= kEverywhere) return;
    if (kind == SPHERES_SPHERE) return sink->sphere(sink->ctx, v, v[3]);
    if (kind == SPHERES_BOX) return sink->box(sink->ctx, v, v + 3);
    float halves[9];
    for (int k = 0; k < 9; ++k) halves[k] = v[3 + k / 3] * axes->axis[k];
    if (RT_HAS(sink, rt_volume_sink, oriented_box)) return sink->oriented_box(sink->ctx, v, halves);
    float lo[3], hi[3];
    for (int k = 0; k < 3; ++k) {
        const float reach = std::fabs(halves[k]) + std::fabs(halves[3 + k]) + std::fabs(halves[6 + k]);
        lo[k] = v[k] - reach, hi[k] = v[k] + reach;
    }
    sink->box(sink->ctx, lo, hi);
}

int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    if (group >= built->group_count) throw rt::fail(host, "was asked for the levels of a group that the scene does not have");
    const auto* const nodes = static_cast<const spheres_node*>(built->slots[0]);
    const auto* const axes = static_cast<const spheres_axes*>(built->slots[1]);
    const rt_u32 head = built->roots[group], kind = *static_cast<const rt_u32*>(built->slots[2]);
    Levels level_of(nodes);
    for (rt_u32 i = head + 1; i < nodes[head].link; ++i) {
        const rt_u32 at = level_of.next(i);
        if (level == RT_LEVEL_BOTTOM ? nodes[i].count > 0 : at == level) show(kind, nodes[i], axes ? axes + i : nullptr, sink);
    }
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "spheres.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<spheres_node>("spheres_nodes", "spheres_node"),
                              rt::slot<spheres_axes>("spheres_axes", "spheres_axes"), rt::host_slot<rt_u32>("spheres_kind")};
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
