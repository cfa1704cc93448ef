// pack_binary.hpp -- writes a topology as an array of binary nodes in depth-first order, in any plugin's layout.
#pragma once
#include <functional>
#include <vector>

#include "clarity_bvh/topology.hpp"
#include "rt_plugin.hpp"

namespace clarity::bvh {

// Assigns the nodes of a topology their places in one array without gaps: in depth-first order, group by group. A group without
// a node, which is a single leaf or empty, gets one place, too, so that every root is a node.
class BinaryOrder {
 public:
    explicit BinaryOrder(const Topology& topology);  // which must outlive this object

    uint32_t count() const { return count_; }                      // number of places
    const std::vector<uint32_t>& roots() const { return roots_; }  // of groups, ascending
    // Calls write(place, node) for every node of the topology, on all cores; the codes of its children that are nodes are
    // places.
    template <class Write>
    void each_node(const rt_host* host, Write&& write) const {
        rt::parallel_for(host, static_cast<rt_u32>(topology_.parts.size()), [&](rt_u32 p) {
            const Part& part = topology_.parts[p];
            const uint32_t shift = part_place_[p] - part.first_node;
            for (uint32_t i = part.first_node; i < part.first_node + part.node_count; ++i) {
                Node node = topology_.nodes.data()[i];
                if (!is_leaf(node.child0)) node.child0 += shift;
                if (!is_leaf(node.child1)) node.child1 += shift;
                write(i + shift, node);
            }
        });
        for (size_t t = 0; t < topology_.tops.size(); ++t) {
            Node node = topology_.nodes.data()[topology_.tops[t].node];
            node.child0 = place_of(node.child0);
            node.child1 = place_of(node.child1);
            write(top_place_[t], node);
        }
    }

 private:
    struct Place {
        uint32_t at, index;
        bool operator<(const Place& other) const { return at < other.at; }
    };

    uint32_t assign(uint32_t code, uint32_t next);
    uint32_t place_of(uint32_t code) const;
    uint32_t top_of(uint32_t node) const;
    uint32_t part_of(uint32_t node) const;

    const Topology& topology_;
    std::vector<uint32_t> part_place_, top_place_, roots_;  // part_place_: of the first node of each part
    std::vector<Place> parts_, tops_;                       // by their place in the topology's array
    uint32_t count_ = 0;
};

// Packs a topology. alloc(count) gives memory for the nodes. write(out, node) converts a node; the boxes and codes are those of
// topology.hpp. The roots of groups that are a single leaf have it as child 0. A missing child is kEmpty, in a box of no extent
// at (FLT_MAX, FLT_MAX, FLT_MAX): slab tests miss it whether they order the two distances of a slab or select them by the sign
// of the direction. Returns the places of the roots.
template <class Alloc, class Write>
std::vector<uint32_t> pack_binary(const rt_host* host, const Topology& topology, Alloc&& alloc, Write&& write) {
    const BinaryOrder order(topology);
    auto* const nodes = alloc(order.count());
    order.each_node(host, [&](uint32_t place, const Node& node) { write(nodes[place], node); });
    Bounds nowhere;
    for (float& bound : nowhere.neg_hi) bound = -FLT_MAX;
    for (size_t g = 0; g < topology.roots.size(); ++g) {
        const Root& root = topology.roots[g];
        if (root.code != RT_NONE && !is_leaf(root.code)) continue;
        const bool empty = root.code == RT_NONE;
        Node node;
        set_child(node, 0, empty ? nowhere : root.box, empty ? kEmpty : root.code);
        set_child(node, 1, nowhere, kEmpty);
        write(nodes[order.roots()[g]], node);
    }
    return order.roots();
}

}  // namespace clarity::bvh
