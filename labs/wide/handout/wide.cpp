// wide.cpp -- the lab's tree: median splits, of which each node takes up to four. You need not change it, and it is not handed
// in.
#include "lab_tree.hpp"
// included after rt_plugin.hpp, because it uses its types:
#include "wide_pack.hpp"

namespace {

struct Packer {
    const lab::Tree& tree;
    wide_node* nodes;
    rt_u32& node_count;
    const rt_u32 first_leaf;

    static bool is_leaf(const rt_topology_node& node) { return node.right & RT_TOPOLOGY_LEAF; }
    static lab::Box box_of(const rt_topology_node& node) {
        lab::Box box;
        box.add(node.lo, node.hi);
        return box;
    }

    // A node with the children of the binary node `root`. While it has room, the largest one that has children gives way to
    // them.
    rt_u32 pack(rt_u32 root) {
        const rt_u32 at = node_count++;
        rt_u32 children[4] = {root};
        int count = 1;
        while (count < 4) {
            int largest = -1;
            for (int i = 0; i < count; ++i)
                if (const auto& node = tree.nodes[children[i]];
                    !is_leaf(node) && (largest < 0 || box_of(node).surface() > box_of(tree.nodes[children[largest]]).surface()))
                    largest = i;
            if (largest < 0) break;
            const rt_topology_node& opened = tree.nodes[children[largest]];
            children[largest] = opened.left, children[count++] = opened.right;
        }
        lab::Box all, boxes[4];
        wide_node made{};
        for (int i = 0; i < count; ++i) {
            boxes[i] = box_of(tree.nodes[children[i]]);
            all.add(boxes[i].lo, boxes[i].hi);
        }
        wide_pack(all, boxes, count, made);
        for (int i = 0; i < 4; ++i) {
            const rt_topology_node* const child = i < count ? &tree.nodes[children[i]] : nullptr;
            made.child[i] = !child ? WIDE_NONE
                            : is_leaf(*child)
                                ? WIDE_LEAF | (child->right & ~RT_TOPOLOGY_LEAF) << 28 | (first_leaf + child->left)
                                : pack(children[i]);
        }
        nodes[at] = made;
        return at;
    }
};

int32_t build(const rt_host*, const rt_build_input* in, const rt_build_output* out) {
    std::vector<lab::Tree> trees;
    uint64_t node_count = 0, ref_count = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        trees.push_back(lab::make_tree(in->prims + in->groups[g].first, in->groups[g].count, lab::split_at_median));
        node_count += trees.back().nodes.size() + 1, ref_count += trees.back().order.size();
    }
    auto* const nodes = rt::alloc<wide_node>(out, 0, node_count);
    rt_u32* const leaves = rt::leaves(out, ref_count);
    rt_u32 node_at = 0, leaf_at = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        if (trees[g].nodes.empty()) {
            nodes[node_at] = {};
            std::fill(nodes[node_at].child, nodes[node_at].child + 4, WIDE_NONE);
            rt::root(out, g, node_at++);
        } else {
            rt::root(out, g, Packer{trees[g], nodes, node_at, leaf_at}.pack(0));
        }
        std::copy(trees[g].order.begin(), trees[g].order.end(), leaves + leaf_at);
        leaf_at += rt_u32(trees[g].order.size());
    }
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "wide.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<wide_node>("wide_nodes", "wide_node")};
constexpr rt_accel kAccel =
    rt::accel(kSlots, rt::file(kFiles, "wide_types.h"), rt::file(kFiles, "wide.cl"), rt::guarded<build>, nullptr, rt::Traits());

}  // namespace

const rt_plugin rt_plugin_v1 = rt::accel_plugin("wide", "Wide nodes in bytes", "1.0.0", nullptr, kAccel);
