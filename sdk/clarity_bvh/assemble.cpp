#include "clarity_bvh/assemble.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "clarity_bvh/kernels/range.hpp"
#include "rt_plugin.hpp"

namespace clarity::bvh {
namespace {

// A node index has 28 bits, so that every layout can refer to it.
constexpr uint64_t kMostNodes = uint64_t{1} << 28;

class Assembler {
 public:
    Assembler(const rt_topology& trees, uint32_t max_leaf)
        : trees_(trees), max_leaf_(max_leaf), below_(trees.node_count), seen_(trees.node_count) {}

    Topology run(const rt_host* host, const RefMemory& refs) {
        uint64_t node_count = 0, ref_count = 0;
        for (uint32_t g = 0; g < trees_.group_count; ++g) {
            if (trees_.roots[g] == RT_NONE) continue;
            const Below& root = survey(trees_.roots[g], 1);
            node_count += root.nodes;
            ref_count += root.refs;
        }
        if (ref_count > kMaxPrimitives)
            refuse("its leaves have " + std::to_string(ref_count) + " refs, at most " + std::to_string(kMaxPrimitives) +
                   " are possible");
        if (node_count >= kMostNodes)
            refuse("it needs " + std::to_string(node_count) + " nodes, at most 2^28 - 1 are possible");

        Topology result{Scratch<Node>(node_count), {}, {}, std::vector<Root>(trees_.group_count)};
        result.ref_count = ref_count;
        refs_ = refs(ref_count);
        nodes_ = result.nodes.data();
        part_size_ = static_cast<uint32_t>(std::clamp<uint64_t>(node_count / 16, 512, 8192));
        std::vector<Job> jobs;
        Place next{0, 0};
        for (uint32_t g = 0; g < trees_.group_count; ++g) {
            if (trees_.roots[g] == RT_NONE) continue;
            const Item root = of_node(trees_.roots[g]);
            result.roots[g].box = below_.data()[trees_.roots[g]].box;
            scale_ = unit_scale(result.roots[g].box);
            result.roots[g].code = plan(root, next, 0, jobs, result);
            next = after(next, root);
        }
        rt::parallel_for(host, static_cast<rt_u32>(jobs.size()), [&](rt_u32 j) {
            uint32_t depth = jobs[j].depth;
            emit(jobs[j].item, jobs[j].place, jobs[j].depth, depth);
            result.parts[j].depth = depth;
        });
        for (const Part& part : result.parts) result.depth = std::max(result.depth, part.depth);
        return result;
    }

 private:
    // What stands below a node of the tree.
    struct Below {
        Bounds box;
        uint64_t refs;
        uint64_t nodes;  // of the topology: inner nodes, and those that a large leaf becomes
    };
    // A subtree of the tree: a node, or some refs of a leaf.
    struct Item {
        const rt_topology_node* node;
        uint32_t first, count;  // refs; count 0: an inner node
    };
    // Where the nodes and the refs of an item begin in the result.
    struct Place {
        uint32_t node, ref;
    };
    struct Job {
        Item item;
        Place place;
        uint32_t depth;  // number of nodes above it
    };

    [[noreturn]] static void refuse(const std::string& why) {
        throw std::invalid_argument("the tree cannot be packed: " + why);
    }

    Item of_node(uint32_t index) const {
        const rt_topology_node& node = trees_.nodes[index];
        if (is_leaf(node.right)) return {&node, node.left, node.right & ~kLeaf};
        return {&node, 0, 0};
    }
    const Bounds& box_of(const Item& item) const { return below_.data()[item.node - trees_.nodes].box; }
    // A leaf is cut at a multiple of max_leaf_, so n leaves take n - 1 nodes.
    uint32_t pieces(uint32_t refs) const { return (refs + max_leaf_ - 1) / max_leaf_; }
    uint32_t nodes_of(const Item& item) const {
        return item.count > 0 ? pieces(item.count) - 1 : static_cast<uint32_t>(below_.data()[item.node - trees_.nodes].nodes);
    }
    Place after(Place place, const Item& item) const {
        const uint32_t refs = item.count > 0 ? item.count : static_cast<uint32_t>(below_.data()[item.node - trees_.nodes].refs);
        return {place.node + nodes_of(item), place.ref + refs};
    }

    // Checks a node and all below, and computes their boxes and numbers of nodes.
    const Below& survey(uint32_t index, uint32_t level) {
        const auto name = [&] { return "node " + std::to_string(index); };
        if (index >= trees_.node_count) refuse(name() + " is named, but there are " + std::to_string(trees_.node_count));
        if (seen_[index]) refuse(name() + " has two parents, or a circle leads through it");
        if (level > RT_TOPOLOGY_DEPTH)
            refuse(name() + " is below " + std::to_string(RT_TOPOLOGY_DEPTH) + " others: split more evenly there");
        seen_[index] = true;
        const rt_topology_node& node = trees_.nodes[index];
        Below& own = below_.data()[index];
        own = {};
        if (is_leaf(node.right)) {
            const uint64_t count = node.right & ~kLeaf;
            if (count == 0) refuse("leaf " + name() + " has no refs");
            if (node.left + count > trees_.ref_count)
                refuse("leaf " + name() + " has refs " + std::to_string(node.left) + " to " +
                       std::to_string(node.left + count - 1) + ", but there are " + std::to_string(trees_.ref_count));
            float lo[3], hi[3];
            for (int a = 0; a < 3; ++a) {
                const float x = node.lo[a] >= -FLT_MAX ? std::min(node.lo[a], FLT_MAX) : -FLT_MAX;
                const float y = node.hi[a] <= FLT_MAX ? std::max(node.hi[a], -FLT_MAX) : FLT_MAX;
                lo[a] = std::min(x, y);
                hi[a] = std::max(x, y);
            }
            own.box.add(lo, hi);
            own.nodes = pieces(static_cast<uint32_t>(count)) - 1;
            own.refs = count;
            return own;
        }
        own.nodes = 1;
        for (const uint32_t child : {node.left, node.right}) {
            const Below& below = survey(child, level + 1);
            own.box.add(below.box);
            own.nodes += below.nodes;
            own.refs += below.refs;
        }
        return own;
    }

    // The children of an item that has nodes, the larger one first.
    void split(const Item& item, Item child[2]) const {
        if (item.count > 0) {
            const uint32_t left = pieces(item.count) / 2 * max_leaf_;
            child[0] = {item.node, item.first, left};
            child[1] = {item.node, item.first + left, item.count - left};
            return;
        }
        child[0] = of_node(item.node->left);
        child[1] = of_node(item.node->right);
        const AreaScale area(box_of(item));
        if (area.half_area(box_of(child[0])) < area.half_area(box_of(child[1]))) std::swap(child[0], child[1]);
    }

    // Writes the refs of a leaf. Returns its code.
    uint32_t leaf(const Item& item, Place place, uint32_t depth, uint32_t& deepest) const {
        std::copy_n(trees_.refs + item.first, item.count, refs_ + place.ref);
        deepest = std::max(deepest, depth);
        return make_leaf(place.ref, item.count);
    }

    // Writes the nodes above the parts and collects the parts. Returns the code of the item.
    uint32_t plan(const Item& item, Place place, uint32_t depth, std::vector<Job>& jobs, Topology& result) {
        const uint32_t count = nodes_of(item);
        if (count == 0) return leaf(item, place, depth, result.depth);
        if (count <= part_size_) {
            result.parts.push_back({place.node, scale_, place.node, count});
            jobs.push_back({item, place, depth});
            return place.node;
        }
        result.tops.push_back({place.node, scale_});
        write(item, place, [&](const Item& child, Place at) { return plan(child, at, depth + 1, jobs, result); });
        return place.node;
    }

    // Writes all nodes of an item depth-first. Returns its code.
    uint32_t emit(const Item& item, Place place, uint32_t depth, uint32_t& deepest) const {
        if (nodes_of(item) == 0) return leaf(item, place, depth, deepest);
        write(item, place, [&](const Item& child, Place at) { return emit(child, at, depth + 1, deepest); });
        return place.node;
    }

    // Writes one node. code_of(child, place) writes a child.
    template <class CodeOf>
    void write(const Item& item, Place place, CodeOf&& code_of) const {
        Item child[2];
        split(item, child);
        const Place first{place.node + 1, place.ref};
        const uint32_t code = code_of(child[0], first);
        set_child(nodes_[place.node], 0, box_of(child[0]), code);
        set_child(nodes_[place.node], 1, box_of(child[1]), code_of(child[1], after(first, child[0])));
    }

    const rt_topology& trees_;
    const uint32_t max_leaf_;
    const Scratch<Below> below_;
    std::vector<bool> seen_;
    Node* nodes_ = nullptr;
    uint32_t* refs_ = nullptr;
    uint32_t part_size_ = 0;
    float scale_ = 0;  // of the current group
};

}  // namespace

Topology assemble(const rt_host* host, const rt_topology& trees, uint32_t max_leaf, const RefMemory& refs) {
    if (max_leaf < 1 || max_leaf > kLeafMax)
        throw std::invalid_argument("max_leaf is " + std::to_string(max_leaf) + ", not 1 to 7");
    return Assembler(trees, max_leaf).run(host, refs);
}

}  // namespace clarity::bvh
