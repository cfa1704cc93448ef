// topology_test.cpp -- trees that plugins build on the device, against those that they build on the host: the same nodes.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/progress.hpp"
#include "plugin/capabilities.hpp"
#include "plugin/host_services.hpp"
#include "plugin/parameters.hpp"
#include "plugin/registry.hpp"
#include "structures/on_device/device_plan.hpp"
#include "support/errors.hpp"

using namespace clarity;

namespace {

struct HostTree {
    std::vector<rt_topology_node> nodes;
    std::vector<rt_u32> refs, roots = {RT_NONE};
};

HostTree build_on_host(const rt_plugin& plugin, const std::vector<rt_prim>& prims) {
    HostTree tree;
    Progress progress;
    HostServices services("test", progress);
    const rt_group group{0, static_cast<rt_u32>(prims.size())};
    rt_device device{};
    device.struct_bytes = sizeof device;
    rt_build_input input{};
    input.struct_bytes = sizeof input;
    input.group_count = 1;
    input.prims = prims.data();
    input.groups = &group;
    input.device = &device;
    rt_topology_output out{};
    out.struct_bytes = sizeof out;
    out.ctx = &tree;
    out.nodes = [](void* ctx, uint64_t count) {
        static_cast<HostTree*>(ctx)->nodes.resize(count + 1);
        return static_cast<HostTree*>(ctx)->nodes.data();
    };
    out.refs = [](void* ctx, uint64_t count) {
        static_cast<HostTree*>(ctx)->refs.resize(count + 1);
        return static_cast<HostTree*>(ctx)->refs.data();
    };
    out.root = [](void* ctx, rt_u32 group, rt_u32 node) { static_cast<HostTree*>(ctx)->roots.at(group) = node; };
    out.stat = [](void*, const char*, double) {};
    EXPECT_EQ(plugin.accel->topology(services.host(), &input, &out), RT_OK);
    return tree;
}

enum class Cloud { spread, clustered, one_point, line, nested };  // nested: each box holds the one before

std::vector<rt_prim> cloud(Cloud kind, size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(-50, 50), size(0, 0.5f);
    std::vector<rt_prim> prims(count);
    for (size_t i = 0; i < count; ++i) {
        prims[i].ref = static_cast<rt_u32>(count - i);
        prims[i].mesh = 0;
        for (int a = 0; a < 3; ++a) {
            float at = place(random);
            if (kind == Cloud::clustered) at = i % 5 == 0 ? at * 1e6f : std::floor(at / 25);
            if (kind == Cloud::one_point) at = 7;
            if (kind == Cloud::line && a > 0) at = -3;
            prims[i].lo[a] = at;
            prims[i].hi[a] = at + (kind == Cloud::one_point ? 0 : size(random));
            if (kind == Cloud::nested) prims[i].hi[a] = -(prims[i].lo[a] = -std::pow(1.01f, float(i % 3000)));
        }
    }
    return prims;
}

class DeviceTopology : public ::testing::TestWithParam<BuildForm> {
 protected:
    static std::shared_ptr<Device> device() {
        static const auto opened = std::make_shared<Device>(choose_device(""));
        return opened;
    }
    template <class T>
    std::vector<T> download(const cl::Buffer& buffer, uint64_t count) {
        std::vector<T> values(count);
        if (count) device()->queue().enqueueReadBuffer(buffer, CL_TRUE, 0, count * sizeof(T), values.data());
        return values;
    }
    BuildKernels kernels_{device(), GetParam()};
    const PluginRegistry plugins_ = PluginRegistry::discover();
    void tree_is_that_of_the_host(const char* id, std::initializer_list<size_t> counts);
    void bvh4_packs_it_whole(const char* id, std::initializer_list<size_t> counts);
};

void DeviceTopology::tree_is_that_of_the_host(const char* id, std::initializer_list<size_t> counts) {
    const rt_plugin* builder = plugins_.accel(id);
    ASSERT_TRUE(builder);
    const rt_device_build build = device_build_of(*builder);
    ASSERT_TRUE(build.topology);
    for (const size_t count : counts) {
        // One plan for all poses, as in a scene that moves.
        DevicePlan plan(kernels_);
        const cl::Buffer boxes = kernels_.buffer(count * sizeof(rt_prim));
        const rt_device_input input{sizeof input, plan.add(boxes), count, nullptr};
        const rt_device_topology tree = plan.plan_topology(*builder, build, input);
        for (const Cloud kind : {Cloud::spread, Cloud::clustered, Cloud::one_point, Cloud::line, Cloud::nested}) {
            SCOPED_TRACE(std::to_string(count) + " primitives, cloud " + std::to_string(int(kind)));
            const std::vector<rt_prim> prims = cloud(kind, count, 5);
            if (count) device()->queue().enqueueWriteBuffer(boxes, CL_TRUE, 0, count * sizeof(rt_prim), prims.data());
            plan.run();
            const HostTree expected = build_on_host(*builder, prims);
            const auto nodes = download<rt_topology_node>(plan.buffer(tree.nodes), count > 1 ? count - 1 : 0);
            const auto order = download<rt_u32>(plan.buffer(tree.order), count);
            const auto counts = download<rt_u32>(plan.buffer(tree.counts), nodes.size());
            const rt_u32 root = nodes.empty() || tree.root == RT_NONE ? 0 : download<rt_u32>(plan.buffer(tree.root), 1)[0];
            ASSERT_EQ(expected.roots[0], count ? root : RT_NONE);
            for (size_t p = 0; p < count; ++p) ASSERT_EQ(prims[order[p]].ref, expected.refs[p]) << p;
            const auto leaves = static_cast<rt_u32>(nodes.size());
            for (rt_u32 i = 0; i < nodes.size(); ++i) {
                const rt_topology_node& node = expected.nodes[i];
                const auto child = [&](rt_u32 code) {
                    return code & RT_TOPOLOGY_LEAF ? leaves + (code & ~RT_TOPOLOGY_LEAF) : code;
                };
                const auto below = [&](rt_u32 code) { return code & RT_TOPOLOGY_LEAF ? 1 : counts[code]; };
                ASSERT_EQ(child(nodes[i].left), node.left) << "node " << i;
                ASSERT_EQ(child(nodes[i].right), node.right) << "node " << i;
                ASSERT_EQ(counts[i], below(nodes[i].left) + below(nodes[i].right)) << "node " << i;
                for (int a = 0; a < 3; ++a) {
                    ASSERT_EQ(nodes[i].lo[a], node.lo[a]) << "node " << i;
                    ASSERT_EQ(nodes[i].hi[a], node.hi[a]) << "node " << i;
                }
            }
            // The bound of the depth holds.
            std::vector<rt_u32> depth(nodes.size(), 0), open;
            if (!nodes.empty()) open.push_back(root), depth[root] = 1;
            while (!open.empty()) {
                const rt_u32 at = open.back();
                open.pop_back();
                ASSERT_LE(depth[at], tree.depth);
                for (const rt_u32 code : {nodes[at].left, nodes[at].right})
                    if (!(code & RT_TOPOLOGY_LEAF)) depth[code] = depth[at] + 1, open.push_back(code);
            }
        }
    }
}

// A tree that has a slot to itself.
struct TreePlace {
    rt_u32 slot;
    uint64_t first = 0, elements;
    rt_device_tree tree;
    TreePlace(rt_u32 slot_buffer, rt_u32 ranges, uint64_t count, uint64_t element_count)
        : slot(slot_buffer),
          elements(element_count),
          tree{sizeof tree, 1, &slot, &first, &elements, RT_NONE, 0, count, ranges, 0} {}
    TreePlace(const TreePlace&) = delete;
};

// A node of bvh4 in memory (bvh4_types.h): eight rows of four numbers, row k of node i at k ^ (i & 7).
struct WideTree {
    std::vector<float> words;
    std::vector<rt_u32> leaves;
    const std::vector<rt_prim>& prims;
    std::vector<int> seen;
    rt_u32 nodes = 0, depth = 0;

    float plane(rt_u32 node, rt_u32 k, rt_u32 slot) const { return words[32 * node + 4 * (k ^ (node & 7)) + slot]; }
    rt_u32 child(rt_u32 node, rt_u32 slot) const {
        rt_u32 code;
        std::memcpy(&code, &words[32 * node + 4 * (6 ^ (node & 7)) + slot], sizeof code);
        return code;
    }
    // Visits everything below a node. Returns an empty text if each box is that of the primitives below it.
    std::string check(rt_u32 node, rt_u32 level, float box[6]) {
        if (32 * (size_t{node} + 1) > words.size()) return "node " + std::to_string(node) + " is behind the slot";
        ++nodes;
        depth = std::max(depth, level);
        float all[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
        for (rt_u32 slot = 0; slot < 4; ++slot) {
            const rt_u32 code = child(node, slot);
            float below[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
            if (code >> 31) {
                const rt_u32 first = code & 0x0FFFFFFFu, count = code >> 28 & 7u;
                for (rt_u32 at = first; at < first + count; ++at) {
                    if (at >= leaves.size() || leaves[at] >= prims.size()) return "a leaf is behind the end";
                    ++seen[at];
                    for (int a = 0; a < 3; ++a) {
                        below[a] = std::min(below[a], prims[leaves[at]].lo[a]);
                        below[3 + a] = std::max(below[3 + a], prims[leaves[at]].hi[a]);
                    }
                }
            } else if (const std::string why = check(code >> 3, level + 1, below); !why.empty()) {
                return why;
            }
            for (rt_u32 k = 0; k < 6; ++k) {
                if (plane(node, k, slot) != below[k]) return "node " + std::to_string(node) + " has a wrong box";
                all[k] = k < 3 ? std::min(all[k], below[k]) : std::max(all[k], below[k]);
            }
        }
        std::copy_n(all, 6, box);
        return {};
    }
};

void DeviceTopology::bvh4_packs_it_whole(const char* id, std::initializer_list<size_t> counts) {
    const rt_plugin *builder = plugins_.accel(id), *bvh4 = plugins_.accel("bvh4");
    ASSERT_TRUE(builder && bvh4);
    const rt_device_build build = device_build_of(*builder), layout = device_build_of(*bvh4);
    ASSERT_TRUE(build.topology && layout.pack);
    const ParameterValues params = default_parameters(*bvh4);
    for (const size_t count : counts) {
        DevicePlan plan(kernels_);
        const cl::Buffer boxes = kernels_.buffer(count * sizeof(rt_prim)), order = kernels_.buffer(4 * count);
        const uint64_t elements = layout.elements(0, count, params.data());
        const cl::Buffer slot = kernels_.buffer(128 * elements);
        const rt_u32 prims = plan.add(boxes), slots = plan.add(slot), leaves = plan.add(order);
        const TreePlace place(slots, plan.add(kernels_.buffer(8 * elements)), count, elements);
        const rt_device_topology tree = plan.plan_topology(*builder, build, {sizeof(rt_device_input), prims, count, nullptr});
        const PlannedLayout planned =
            plan.plan_layout(*bvh4, layout, {sizeof(rt_device_input), prims, count, params.data()}, tree, place.tree, leaves);
        for (const Cloud kind : {Cloud::spread, Cloud::clustered, Cloud::one_point, Cloud::line}) {
            if (count > 100000 && kind != Cloud::spread && kind != Cloud::one_point) continue;  // takes seconds
            SCOPED_TRACE(std::to_string(count) + " primitives, cloud " + std::to_string(int(kind)));
            const std::vector<rt_prim> scene = cloud(kind, count, 9);
            if (count) device()->queue().enqueueWriteBuffer(boxes, CL_TRUE, 0, count * sizeof(rt_prim), scene.data());
            plan.run();
            WideTree wide{download<float>(slot, 32 * elements), download<rt_u32>(order, count), scene,
                          std::vector<int>(count, 0)};
            float box[6];
            ASSERT_EQ(wide.check(planned.root, 1, box), "");
            for (size_t at = 0; at < count; ++at) ASSERT_EQ(wide.seen[at], 1) << "position " << at;
            std::vector<rt_u32> numbers = wide.leaves;
            std::sort(numbers.begin(), numbers.end());
            for (rt_u32 i = 0; i < count; ++i) ASSERT_EQ(numbers[i], i);
            EXPECT_LE(wide.nodes, elements);
            EXPECT_LE(3 * (wide.depth - 1) + 1, planned.defines.at("BVH4_STACK"));
        }
    }
}

TEST_P(DeviceTopology, LbvhIsTheTreeOfTheHost) {
    tree_is_that_of_the_host("lbvh", {0, 1, 2, 3, 255, 256, 257, 513, 3000});
}
TEST_P(DeviceTopology, LbvhIsTheTreeOfTheHostForMany) {
    tree_is_that_of_the_host("lbvh", {70000, 300000});
}
TEST_P(DeviceTopology, PlocIsTheTreeOfTheHost) {
    tree_is_that_of_the_host("ploc", {0, 1, 2, 3, 16, 17, 31, 32, 33, 64, 255, 257, 513, 3000});
}
TEST_P(DeviceTopology, PlocIsTheTreeOfTheHostForMany) {
    tree_is_that_of_the_host("ploc", {4096, 4097, 70000, 300000});
}
TEST_P(DeviceTopology, Bvh4PacksItWhole) {
    for (const char* id : {"lbvh", "ploc"}) bvh4_packs_it_whole(id, {0, 1, 2, 4, 5, 17, 32, 33, 512, 513, 3000});
}
TEST_P(DeviceTopology, Bvh4PacksItWholeForMany) {
    bvh4_packs_it_whole("ploc", {300000});  // two passes from large subtrees to small ones
}

TEST_P(DeviceTopology, APlanThatCannotBeMadeSaysWhy) {
    const rt_plugin* lbvh = plugins_.accel("lbvh");
    ASSERT_TRUE(lbvh);
    DevicePlan plan(kernels_);
    const rt_device_input input{sizeof input, 77, 100, nullptr};  // a buffer that there is not
    expect_error([&] { plan.plan_topology(*lbvh, device_build_of(*lbvh), input); }, {"accel lbvh", "buffer 77"});
}

// Not a test: prints how long a rebuild takes, to be read while one works on it. Run with --gtest_also_run_disabled_tests
// --gtest_filter='*Times*'.
TEST_P(DeviceTopology, DISABLED_Times) {
    const rt_plugin* const bvh4 = plugins_.accel("bvh4");
    ASSERT_TRUE(bvh4);
    const rt_device_build layout = device_build_of(*bvh4);
    const ParameterValues params = default_parameters(*bvh4);
    for (const size_t count : {10000u, 100000u, 1000000u, 10000000u})
        for (const char* id : {"lbvh", "ploc"}) {
            const rt_plugin& builder = *plugins_.accel(id);
            const rt_device_build build = device_build_of(builder);
            std::vector<rt_prim> scene = cloud(Cloud::spread, count, 3);
            DevicePlan plan(kernels_);
            const cl::Buffer boxes = kernels_.buffer(count * sizeof(rt_prim)), order = kernels_.buffer(4 * count);
            const uint64_t elements = layout.elements(0, count, params.data());
            const cl::Buffer slot = kernels_.buffer(128 * elements);
            Queue& queue = device()->queue();
            queue.enqueueWriteBuffer(boxes, CL_TRUE, 0, count * sizeof(rt_prim), scene.data());
            const rt_u32 prims = plan.add(boxes), slots = plan.add(slot), leaves = plan.add(order);
            const TreePlace place(slots, plan.add(kernels_.buffer(8 * elements)), count, elements);
            const rt_device_topology tree =
                plan.plan_topology(builder, build, {sizeof(rt_device_input), prims, count, nullptr});
            const size_t of_tree = plan.steps();
            plan.plan_layout(*bvh4, layout, {sizeof(rt_device_input), prims, count, params.data()}, tree, place.tree, leaves);
            std::vector<double> by_events, wall;
            for (int run = 0; run < 12; ++run) {
                cl::Event first, last;
                const auto start = std::chrono::steady_clock::now();
                plan.run();  // so that the next one begins at once, and not when the host has sent it
                queue.enqueueMarkerWithWaitList(nullptr, &first);
                plan.run();
                queue.enqueueMarkerWithWaitList(nullptr, &last);
                queue.finish();
                wall.push_back(ms_since(start) / 2);
                by_events.push_back(1e-6 * double(last.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
                                                  first.getProfilingInfo<CL_PROFILING_COMMAND_END>()));
            }
            std::sort(by_events.begin(), by_events.end());
            std::sort(wall.begin(), wall.end());
            std::printf("%s, %zu primitives: %.3f ms by events, %.3f ms wall (medians of 12), %zu + %zu steps, %.1f MB\n", id,
                        count, by_events[6], wall[6], of_tree, plan.steps() - of_tree, 1e-6 * double(plan.bytes()));
        }
}

INSTANTIATE_TEST_SUITE_P(, DeviceTopology, ::testing::Values(BuildForm::groups, BuildForm::serial),
                         [](const auto& info) { return info.param == BuildForm::groups ? "groups" : "serial"; });

}  // namespace
