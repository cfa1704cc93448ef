#include "render/accel/topology_build.hpp"

#include <algorithm>
#include <chrono>
#include <mutex>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/scoped_fp_mode.hpp"
#include "plugin/host_services.hpp"

namespace clarity {
namespace {

// Refs have 28 bits, and a tree has at most one node fewer than leaves; the rest is room for builders that guess.
constexpr uint64_t kMostNodes = uint64_t(4) * RT_REF_INDEX_MAX;

// Receives what the plugin's builder writes. Its functions are thread-safe.
struct Output {
    TopologyData& data;
    HostServices& services;
    std::vector<std::pair<std::string, double>>& stats;
    std::vector<bool> rooted;
    bool nodes_given = false, refs_given = false;
    std::mutex mutex;

    void* allocate(AlignedBytes& memory, bool& given, const char* what, uint64_t count, uint64_t most, size_t element_bytes) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (given) return refuse(std::string("asked for the ") + what + " twice");
        if (count > most) return refuse("asked for " + std::to_string(count) + " " + what);
        given = true;
        try {
            memory = AlignedBytes(std::max<uint64_t>(count, 1) * element_bytes, true);
        } catch (const std::bad_alloc&) {
            return refuse("no memory for " + std::to_string(count) + " " + what);
        }
        return memory.data();
    }
    void root(rt_u32 group, rt_u32 node) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (group >= rooted.size()) {
            refuse("reported a root for group " + std::to_string(group) + " of " + std::to_string(rooted.size()));
            return;
        }
        rooted[group] = true;
        data.roots[group] = node;
    }
    void* refuse(const std::string& why) {
        services.fail("the builder " + why);
        return nullptr;
    }
};

Output& output(void* ctx) {
    return *static_cast<Output*>(ctx);
}

rt_topology_output table_of(Output& out) {
    rt_topology_output table{};
    table.struct_bytes = sizeof table;
    table.ctx = &out;
    table.nodes = [](void* ctx, uint64_t count) {
        Output& o = output(ctx);
        void* memory = o.allocate(o.data.nodes, o.nodes_given, "nodes", count, kMostNodes, sizeof(rt_topology_node));
        if (memory) o.data.node_count = count;
        return static_cast<rt_topology_node*>(memory);
    };
    table.refs = [](void* ctx, uint64_t count) {
        Output& o = output(ctx);
        void* memory = o.allocate(o.data.refs, o.refs_given, "refs", count, RT_REF_INDEX_MAX, sizeof(rt_u32));
        if (memory) o.data.ref_count = count;
        return static_cast<rt_u32*>(memory);
    };
    table.root = [](void* ctx, rt_u32 group, rt_u32 node) { output(ctx).root(group, node); };
    table.stat = [](void* ctx, const char* label, double value) {
        const std::lock_guard<std::mutex> lock(output(ctx).mutex);
        if (label)
            output(ctx).stats.emplace_back(label, value);
        else
            output(ctx).refuse("gave a stat no label");
    };
    return table;
}

// Walks the trees of all groups.
class Checker {
 public:
    Checker(const TopologyData& data, const BuildScene& scene)
        : data_(data),
          scene_(scene),
          nodes_(static_cast<const rt_topology_node*>(data.nodes.data())),
          refs_(static_cast<const rt_u32*>(data.refs.data())),
          seen_(data.node_count) {}

    // Returns what is wrong with the tree of a group, in terms of its builder; empty: nothing.
    std::string check(rt_u32 group) {
        const rt_u32 count = scene_.groups[group].count, root = data_.roots[group];
        const std::string of_group = " of group " + std::to_string(group);
        if (root == RT_NONE)
            return count == 0
                       ? ""
                       : "reported no tree for group " + std::to_string(group) + ", which has " + number(count, "primitive");
        uint64_t named = 0;
        struct Visit {
            rt_u32 node, depth;
        };
        std::vector<Visit> stack = {{root, 1}};
        while (!stack.empty()) {
            const Visit at = stack.back();
            stack.pop_back();
            const auto name = [&] { return "node " + std::to_string(at.node) + of_group; };
            if (at.node >= data_.node_count) return "named " + name() + ", but asked for " + number(data_.node_count, "node");
            if (seen_[at.node]) return "gave " + name() + " two parents, or a circle leads through it";
            if (at.depth > RT_TOPOLOGY_DEPTH)
                return "made a tree" + of_group + " with more than " + std::to_string(RT_TOPOLOGY_DEPTH) +
                       " nodes above each other: split more evenly there";
            seen_[at.node] = true;
            const rt_topology_node& node = nodes_[at.node];
            if (!(node.right & RT_TOPOLOGY_LEAF)) {
                stack.push_back({node.right, at.depth + 1});
                stack.push_back({node.left, at.depth + 1});
                continue;
            }
            const uint64_t size = node.right & ~RT_TOPOLOGY_LEAF;
            if (size == 0) return "made " + name() + " a leaf without refs";
            if (node.left + size > data_.ref_count)
                return "gave leaf " + name() + " refs " + std::to_string(node.left) + " to " +
                       std::to_string(node.left + size - 1) + ", but asked for " + number(data_.ref_count, "ref");
            for (uint64_t i = node.left; i < node.left + size; ++i)
                if (!is_known_ref(refs_[i], scene_))
                    return "put a ref at place " + std::to_string(i) + " that it was not given";
            named += size;
        }
        if (named < count)
            return "lost primitives" + of_group + ": its leaves name " + number(named, "ref") + ", it was given " +
                   std::to_string(count);
        return {};
    }

 private:
    static std::string number(uint64_t count, const char* what) {
        return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
    }

    const TopologyData& data_;
    const BuildScene& scene_;
    const rt_topology_node* nodes_;
    const rt_u32* refs_;
    std::vector<bool> seen_;
};

std::string check(const Output& out, const BuildScene& scene) {
    if (!out.nodes_given) return "never asked for nodes";
    if (!out.refs_given) return "never asked for refs";
    for (rt_u32 g = 0; g < out.rooted.size(); ++g)
        if (!out.rooted[g]) return "reported no root for group " + std::to_string(g);
    Checker checker(out.data, scene);
    for (rt_u32 g = 0; g < out.rooted.size(); ++g)
        if (std::string why = checker.check(g); !why.empty()) return why;
    return {};
}

}  // namespace

rt_topology TopologyData::view() const {
    return {sizeof(rt_topology), static_cast<rt_u32>(roots.size()),       static_cast<const rt_topology_node*>(nodes.data()),
            node_count,          static_cast<const rt_u32*>(refs.data()), ref_count,
            roots.data()};
}

TopologyData build_topology(const BuildScene& scene, const rt_plugin& plugin, const rt_build_input& input, Progress& progress,
                            std::vector<std::pair<std::string, double>>& stats) {
    TopologyData data;
    data.roots.assign(input.group_count, RT_NONE);
    HostServices services(std::string("accel ") + plugin.id, progress);
    Output out{data, services, stats, std::vector<bool>(input.group_count), false, false, {}};
    const rt_topology_output table = table_of(out);
    auto start = std::chrono::steady_clock::now();
    services.check(static_cast<int>(Exit::failed), [&] {
        const ScopedFpMode floats;
        return plugin.accel->topology(services.host(), &input, &table);
    });
    data.build_ms = ms_since(start);
    start = std::chrono::steady_clock::now();
    const std::string why = check(out, scene);
    if (!why.empty())
        throw Error(Exit::failed,
                    std::string("accel ") + plugin.id + ": the builder " + why + "; this is a fault of the plugin");
    data.check_ms = ms_since(start);
    return data;
}

}  // namespace clarity
