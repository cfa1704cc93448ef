#include "pack.hpp"

#include <algorithm>
#include <cfloat>

#include "rt_plugin.hpp"

namespace bvh2 {
namespace {

constexpr rt_u32 kNone = BVH2_MAKE_LEAF(0u, 0u);
constexpr rt_u32 kReportEvery = 1u << 16;  // nodes

// A subtree whose node in the result is not written yet.
struct Pending {
    const rt_topology_node* node;
    rt_u32 first, count;   // refs of the leaf or of the part of a leaf; count 0: an inner node
    rt_u32 parent, which;  // where its code goes; parent RT_NONE: it is a root
    uint32_t depth;
};

class Packer {
 public:
    Packer(const rt_host* host, const rt_topology& topology) : host_(host), topology_(topology) {
        // An upper bound of the usual case, in which no leaf must be divided.
        packed_.nodes.reserve(topology.node_count / 2 + topology.group_count);
    }

    void add_group(rt_u32 root) {
        packed_.roots.push_back(static_cast<rt_u32>(packed_.nodes.size()));
        if (root == RT_NONE) {
            const rt_u32 at = add_node(1);
            clear_child(at, 0);
            clear_child(at, 1);
            return;
        }
        const Pending top = pending(root, RT_NONE, 0, 1);
        if (top.count > 0 && top.count <= BVH2_LEAF_MAX) {  // the root must be a node
            const rt_u32 at = add_node(1);
            set_child(at, 0, *top.node, BVH2_MAKE_LEAF(top.first, top.count));
            clear_child(at, 1);
            return;
        }
        stack_.push_back(top);
        while (!stack_.empty()) {
            const Pending next = stack_.back();
            stack_.pop_back();
            expand(next);
        }
    }
    Packed take() { return std::move(packed_); }

 private:
    Pending pending(rt_u32 index, rt_u32 parent, rt_u32 which, uint32_t depth) const {
        const rt_topology_node& node = topology_.nodes[index];
        const bool leaf = (node.right & RT_TOPOLOGY_LEAF) != 0;
        return {&node, leaf ? node.left : 0, leaf ? node.right & ~RT_TOPOLOGY_LEAF : 0, parent, which, depth};
    }
    rt_u32 add_node(uint32_t depth) {
        if (packed_.nodes.size() % kReportEvery == 0)
            rt::progress(host_, static_cast<float>(packed_.nodes.size()) / static_cast<float>(topology_.node_count + 1));
        packed_.depth = std::max(packed_.depth, depth);
        packed_.nodes.push_back({});
        return static_cast<rt_u32>(packed_.nodes.size() - 1);
    }
    void clear_child(rt_u32 at, int which) {
        rt_topology_node nowhere{};
        std::fill_n(nowhere.lo, 3, FLT_MAX);
        std::fill_n(nowhere.hi, 3, FLT_MAX);
        set_child(at, which, nowhere, kNone);
    }
    void set_child(rt_u32 at, int which, const rt_topology_node& box, rt_u32 code) {
        bvh2_node& node = packed_.nodes[at];
        float* const to = which == 0 ? node.box0 : node.box1;
        std::copy_n(box.lo, 3, to);
        std::copy_n(box.hi, 3, to + 3);
        (which == 0 ? node.child0 : node.child1) = code;
    }

    // Writes the node of a subtree. Its children that are nodes follow later, the first one next (depth-first order).
    void expand(const Pending& of) {
        const rt_u32 at = add_node(of.depth);
        if (of.parent != RT_NONE) (of.which == 0 ? packed_.nodes[of.parent].child0 : packed_.nodes[of.parent].child1) = at;
        Pending children[2];
        if (of.count > 0) {  // a part of a large leaf
            const rt_u32 half = of.count / 2;
            children[0] = {of.node, of.first, half, at, 0, of.depth + 1};
            children[1] = {of.node, of.first + half, of.count - half, at, 1, of.depth + 1};
        } else {
            children[0] = pending(of.node->left, at, 0, of.depth + 1);
            children[1] = pending(of.node->right, at, 1, of.depth + 1);
        }
        for (int which : {1, 0}) {
            const Pending& child = children[which];
            const bool leaf = child.count > 0 && child.count <= BVH2_LEAF_MAX;
            set_child(at, which, *child.node, leaf ? BVH2_MAKE_LEAF(child.first, child.count) : 0);
            if (!leaf) stack_.push_back(child);
        }
    }

    const rt_host* const host_;
    const rt_topology& topology_;
    Packed packed_;
    std::vector<Pending> stack_;
};

}  // namespace

Packed pack_topology(const rt_host* host, const rt_topology& topology) {
    Packer packer(host, topology);
    for (rt_u32 g = 0; g < topology.group_count; ++g) packer.add_group(topology.roots[g]);
    return packer.take();
}

}  // namespace bvh2
