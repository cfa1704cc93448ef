#include "clarity_bvh/build/reinsert.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "clarity_bvh/assemble.hpp"
#include "rt_plugin.hpp"

namespace clarity::bvh {
namespace {

// A place of a subtree: twice the index of the node that it is a child of, plus 0 or 1. So the sibling of a place is place ^ 1.
// A node keeps its own place in work0, and in work1 its height: the nodes on the longest way from it to a leaf.
using Place = uint32_t;
constexpr Place kNowhere = RT_NONE;  // the place of a root

constexpr size_t kBatch = 4096, kJob = 64;  // subtrees that are searched on one and the same tree, at least; and by one thread
constexpr uint32_t kMoreDepth = 4;          // stacks of traversals follow the depth; a tree of 28 nodes became one of 63
constexpr double kLeastShare = 1e-3;        // of the surface: a pass that gains less is the last

struct Box {
    Vec4 lo, hi;
};
Box join(const Box& a, const Box& b) {
    return {min(a.lo, b.lo), max(a.hi, b.hi)};
}

// A new place of the subtree at `from`, and by how much it lowers the sum of the nodes' surfaces.
struct Move {
    float gain = 0;
    Place from = kNowhere, to = kNowhere;
    // An order without ties, so that it does not depend on how it is sorted.
    bool operator<(const Move& other) const { return gain != other.gain ? gain > other.gain : from < other.from; }
};

// The tree of a group.
class Tree {
 public:
    Tree(Node* nodes, float scale, uint32_t most_depth) : nodes_(nodes), scale_(scale), most_depth_(most_depth) {}

    // Sets the places and heights of a node and of all below, and appends the places in them. Returns the sum of the surfaces.
    double link(uint32_t node, Place at, std::vector<Place>& places) {
        place_of(node) = at;
        double sum = exact_area(join(box(2 * node), box(2 * node + 1)));
        for (const Place below : {2 * node, 2 * node + 1}) {
            places.push_back(below);
            if (!is_leaf(child(below))) sum += link(child(below), below, places);
        }
        height(node) = height_of_children(node);
        return sum;
    }

    struct Open {
        uint32_t node;
        float gain;  // as in Move, of a place below the node, without the cost of the new node there
    };
    // Searches the whole tree for the best place, from near to far: up the way to the root, and at each step down the other
    // branch. What is gained by taking the subtree out is known there, and each step down only costs. So a way ends where it
    // cannot beat the best place any more. Without a better place, the result gains nothing.
    Move search(Place from, std::vector<Open>& open) const {
        Move best{0, from, kNowhere};
        if (is_fixed(from)) return best;
        const Box moved = box(from);
        const float least = area(moved);  // the new node holds the subtree
        const auto look = [&](Place at, float gain) {
            const Box there = box(at);
            const float joined = area(join(there, moved));
            if (gain - joined > best.gain) best = {gain - joined, from, at};
            gain -= joined - area(there);
            if (!is_leaf(child(at)) && gain - least > best.gain) open.push_back({child(at), gain});
        };
        float gain = area(box(place_of(from >> 1)));  // the parent goes
        Box rest = box(from ^ 1);                     // of the node that is left, without the subtree
        for (Place at = from;;) {
            look(at ^ 1, gain);
            while (!open.empty()) {
                const Open next = open.back();
                open.pop_back();
                if (!(next.gain - least > best.gain)) continue;
                look(2 * next.node, next.gain);
                look(2 * next.node + 1, next.gain);
            }
            rest = join(rest, box(at ^ 1));
            const bool is_parent = at == from;
            at = place_of(at >> 1);
            if (at == kNowhere) return best;
            if (is_parent) continue;
            if (gain - area(rest) > best.gain) best = {gain - area(rest), from, at};  // beside the node that is left
            gain += area(box(at)) - area(rest);
        }
    }

    // Moves a subtree if that pays in the tree as it is now. Returns what it gained.
    double apply(const Move& move) {
        const uint32_t parent = move.from >> 1;
        if (is_fixed(move.from) || move.to >> 1 == parent || move.to == place_of(parent)) return 0;
        const double gain = gain_of(move);
        if (!(gain > 1e-12)) return 0;  // rounding errors are smaller
        const Place old = place_of(parent), sibling = move.from ^ 1;
        copy(sibling, old);
        copy(move.to, sibling);
        put(move.to, parent);
        update(old);
        update(move.to);
        return gain;
    }

    float area_at(Place at) const { return area(box(at)); }

 private:
    uint32_t& child(Place at) const { return at & 1 ? nodes_[at >> 1].child1 : nodes_[at >> 1].child0; }
    float* box_at(Place at) const { return at & 1 ? nodes_[at >> 1].box1 : nodes_[at >> 1].box0; }
    Place& place_of(uint32_t node) const { return nodes_[node].work0; }
    uint32_t& height(uint32_t node) const { return nodes_[node].work1; }
    uint32_t height_at(Place at) const { return is_leaf(child(at)) ? 0 : height(child(at)); }
    uint32_t height_of_children(uint32_t node) const { return 1 + std::max(height_at(2 * node), height_at(2 * node + 1)); }
    Box box(Place at) const { return {load_any(box_at(at)), load_any(box_at(at) + 3)}; }
    // A root and its children stay where they are.
    bool is_fixed(Place at) const { return place_of(at >> 1) == kNowhere; }

    // Half the surface, in the unit of scale_.
    float area(const Box& box) const { return half_area(box.lo, box.hi, scale_); }
    // The same for sums and differences that are compared with 0.
    double exact_area(const Box& box) const {
        alignas(16) float lo[4], hi[4];
        store(lo, box.lo);
        store(hi, box.hi);
        double side[3];
        for (int a = 0; a < 3; ++a) side[a] = 0.5 * scale_ * (double{hi[a]} - lo[a]);
        return side[0] * side[1] + side[2] * (side[0] + side[1]);
    }

    void put(Place at, uint32_t code) const {
        child(at) = code;
        if (!is_leaf(code)) place_of(code) = at;
    }
    void copy(Place from, Place to) const {
        std::copy_n(box_at(from), 6, box_at(to));
        put(to, child(from));
    }
    // Corrects the boxes and heights from a place up to the root.
    void update(Place at) const {
        for (; at != kNowhere; at = place_of(at >> 1)) {
            const uint32_t node = child(at);
            if (is_leaf(node)) continue;
            const Box whole = join(box(2 * node), box(2 * node + 1));
            alignas(16) float lo[4], hi[4];
            store(lo, whole.lo);
            store(hi, whole.hi);
            std::copy_n(lo, 3, box_at(at));
            std::copy_n(hi, 3, box_at(at) + 3);
            height(node) = height_of_children(node);
        }
    }

    void list_nodes_above(Place at, std::vector<uint32_t>& nodes) const {
        for (nodes.clear(); at != kNowhere; at = place_of(at >> 1)) nodes.push_back(at >> 1);
    }
    // What a move gains in the tree as it is now. 0 if it cannot be made.
    double gain_of(const Move& move) {
        list_nodes_above(move.from, above_from_);
        list_nodes_above(move.to, above_to_);
        if (above_to_.size() + 1 + std::max(height_at(move.from), height_at(move.to)) > most_depth_) return 0;
        size_t from = above_from_.size(), to = above_to_.size();  // nodes of each way below the last that both share
        while (from > 0 && to > 0 && above_from_[from - 1] == above_to_[to - 1]) --from, --to;
        if (from == 0 && to > 0 && place_of(above_to_[to - 1]) == move.from) return 0;  // into itself

        double gain = exact_area(box(place_of(above_from_[0])));  // the parent goes
        Box rest = box(move.from ^ 1);
        for (size_t i = 1; i < from; ++i) {
            rest = join(rest, box(place_of(above_from_[i - 1]) ^ 1));
            gain += exact_area(box(place_of(above_from_[i]))) - exact_area(rest);
        }
        if (from > 0 && place_of(above_from_[from - 1]) == move.to) return gain - exact_area(box(move.to));  // higher up
        const Box moved = box(move.from);
        gain -= exact_area(join(box(move.to), moved));
        for (size_t i = 0; i < to; ++i) {
            const Box there = box(place_of(above_to_[i]));
            gain -= exact_area(join(there, moved)) - exact_area(there);
        }
        return gain;
    }

    Node* const nodes_;
    const float scale_;
    const uint32_t most_depth_;
    std::vector<uint32_t> above_from_, above_to_;  // of gain_of()
};

// Returns the `count` places with the largest subtrees, the largest first. If that is all places, they keep their order.
std::vector<Place> largest(const Tree& tree, const std::vector<Place>& places, size_t count) {
    if (count == places.size()) return places;
    std::vector<std::pair<float, Place>> keys;
    keys.reserve(places.size());
    for (const Place at : places) keys.emplace_back(-tree.area_at(at), at);
    std::nth_element(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(count), keys.end());
    keys.resize(count);
    std::sort(keys.begin(), keys.end());
    std::vector<Place> result;
    result.reserve(count);
    for (const auto& key : keys) result.push_back(key.second);
    return result;
}

// Looks for better places of these subtrees, and moves them. Returns what that gained. report(share) tells the progress.
template <class Report>
double pass(const rt_host* host, Tree& tree, const std::vector<Place>& places, Report&& report) {
    double gained = 0;
    const size_t batch = std::max(kBatch, places.size() / 32);
    std::vector<Move> moves;
    for (size_t first = 0; first < places.size(); first += batch) {
        moves.resize(std::min(batch, places.size() - first));
        rt::parallel_for(host, static_cast<rt_u32>((moves.size() + kJob - 1) / kJob), [&](rt_u32 job) {
            std::vector<Tree::Open> open;
            for (size_t i = job * kJob; i < std::min(moves.size(), (job + 1) * kJob); ++i)
                moves[i] = tree.search(places[first + i], open);
        });
        std::sort(moves.begin(), moves.end());
        for (size_t i = 0; i < moves.size() && moves[i].gain > 0; ++i) gained += tree.apply(moves[i]);
        report(static_cast<float>(first) / static_cast<float>(places.size()));
    }
    return gained;
}

// Lists the trees for assemble(), with leaves joined where that is cheaper.
class JoinedLeaves {
 public:
    JoinedLeaves(const Topology& tree, const Rules& rules, const uint32_t* refs_in)
        : tree_(tree), rules_(rules), refs_in_(refs_in), nodes_(2 * tree.ref_count), refs_(tree.ref_count) {
        for (const Root& root : tree.roots) {
            roots_.push_back(root.code == RT_NONE ? RT_NONE : node_count_);
            scale_ = unit_scale(root.box);
            const float box[7] = {root.box.lo[0], root.box.lo[1], root.box.lo[2],
                                  root.box.hi(0), root.box.hi(1), root.box.hi(2)};
            if (root.code != RT_NONE) write(box, root.code);
        }
    }
    rt_topology trees() const {
        return {sizeof(rt_topology), static_cast<rt_u32>(roots_.size()), nodes_.data(), node_count_, refs_.data(), ref_count_,
                roots_.data()};
    }

 private:
    // Writes a subtree, and returns its cost. Seven numbers of `box` are read.
    double write(const float* box, uint32_t code) {
        const uint32_t index = node_count_++, first = ref_count_;
        rt_topology_node& to = nodes_.data()[index];
        const double area = half_area(box, scale_);
        double cost = INFINITY;
        std::copy_n(box, 3, to.lo);
        std::copy_n(box + 3, 3, to.hi);
        if (is_leaf(code)) {
            std::copy_n(refs_in_ + leaf_first(code), leaf_count(code), refs_.data() + first);
            ref_count_ += leaf_count(code);
        } else {
            const Node& node = tree_.nodes.data()[code];
            to.left = node_count_;
            cost = rules_.traversal_cost * area + write(node.box0, node.child0);
            to.right = node_count_;
            cost += write(node.box1, node.child1);
        }
        const uint32_t count = ref_count_ - first;
        const double as_leaf = rules_.intersection_cost * area * count;
        if (!is_leaf(code) && (count > rules_.max_leaf || cost < as_leaf)) return cost;
        node_count_ = index + 1;
        to.left = first;
        to.right = kLeaf | count;
        return as_leaf;
    }

    const Topology& tree_;
    const Rules& rules_;
    const uint32_t* const refs_in_;
    const Scratch<rt_topology_node> nodes_;
    const Scratch<uint32_t> refs_;
    std::vector<uint32_t> roots_;
    uint32_t node_count_ = 0, ref_count_ = 0;
    float scale_ = 0;
};

}  // namespace

uint64_t reinsert_bytes(uint64_t ref_count) {
    constexpr uint64_t kAssembled = 2 * 64 + sizeof(Node);  // what assemble() needs, for each ref
    return ref_count * (sizeof(Node) + 2 * sizeof(rt_topology_node) + 2 * sizeof(uint32_t) + kAssembled);
}

Topology reinsert(const rt_host* host, Topology tree, const Rules& rules, const uint32_t* refs_in, const RefMemory& refs,
                  float begin, float end) {
    const uint32_t most_depth = std::max(tree.depth, std::min(tree.depth + kMoreDepth, kMaxDepth));
    for (size_t g = 0; g < tree.roots.size(); ++g) {
        const Root& root = tree.roots[g];
        if (root.code == RT_NONE || is_leaf(root.code)) continue;
        Tree group(tree.nodes.data(), unit_scale(root.box), most_depth);
        std::vector<Place> places;
        double area = group.link(root.code, kNowhere, places), gained = area;
        size_t count = places.size() / 64;
        for (uint32_t p = 0; p < rules.reinsert && !(count == places.size() && gained < kLeastShare * area); ++p) {
            count = std::min(places.size(), std::max(p == 0 ? count : 4 * count, kBatch));
            gained = pass(host, group, largest(group, places, count), [&](float share) {
                const auto done = (static_cast<float>(p) + share) / static_cast<float>(rules.reinsert);
                rt::progress(host,
                             begin + (end - begin) * (static_cast<float>(g) + done) / static_cast<float>(tree.roots.size()));
            });
            area -= gained;
        }
    }
    const JoinedLeaves joined(tree, rules, refs_in);
    return assemble(host, joined.trees(), rules.max_leaf, refs);
}

}  // namespace clarity::bvh
