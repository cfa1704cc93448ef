#include "clarity_bvh/build/treelets.hpp"

#include <algorithm>
#include <cmath>

#include "clarity_bvh/assemble.hpp"
#include "clarity_bvh/rules.hpp"
#include "rt_plugin.hpp"

namespace clarity::bvh {
namespace {

constexpr uint32_t kMost = 7, kSets = 1u << kMost;  // subtrees of a treelet, and sets of them
constexpr uint32_t kPart = 2048;                    // leaves below a node that one thread optimises with all below it

// A node or a leaf of the tree that is optimised.
struct Item {
    Bounds box;
    uint32_t left, right;     // as in rt_topology_node
    uint32_t leaves, height;  // number of leaves below; number of nodes on the path to the deepest one
    double cost;  // of itself and all below: node areas times the cost of a node; the leaves' own costs never change
};

// In double precision, in which neither huge nor tiny coordinates are out of range.
double half_area(const Bounds& box) {
    const double x = double{box.hi(0)} - box.lo[0], y = double{box.hi(1)} - box.lo[1], z = double{box.hi(2)} - box.lo[2];
    return x * y + z * (x + y);
}

class Optimizer {
 public:
    Optimizer(const Topology& from, float node_cost) : from_(from), node_cost_(double{node_cost}) {
        items_.reserve(2 * from.node_count() + from.roots.size());
        for (const Root& root : from.roots) roots_.push_back(root.code == RT_NONE ? RT_NONE : add(root.box, root.code));
    }

    // One pass over the trees of all groups.
    void pass(const rt_host* host) {
        std::vector<Job> jobs, tops;
        for (const uint32_t root : roots_)
            if (root != RT_NONE) collect(root, 0, jobs, tops);
        rt::parallel_for(host, static_cast<rt_u32>(jobs.size()), [&](rt_u32 j) { optimize_all(jobs[j].item, jobs[j].level); });
        for (size_t t = tops.size(); t-- > 0;) optimize(tops[t].item, tops[t].level);
    }

    Topology result(const rt_host* host, const uint32_t* old_refs, const RefMemory& refs) const {
        std::vector<rt_topology_node> nodes(items_.size());
        for (size_t i = 0; i < items_.size(); ++i) {
            const Item& item = items_[i];
            for (int a = 0; a < 3; ++a) {
                nodes[i].lo[a] = item.box.lo[a];
                nodes[i].hi[a] = item.box.hi(a);
            }
            nodes[i].left = item.left;
            nodes[i].right = item.right;
        }
        const rt_topology trees{
            sizeof(rt_topology), static_cast<rt_u32>(roots_.size()), nodes.data(), nodes.size(), old_refs, from_.ref_count,
            roots_.data()};
        return assemble(host, trees, kLeafMax, refs);
    }

 private:
    struct Job {
        uint32_t item, level;  // level: number of nodes above it
    };

    uint32_t add(const Bounds& box, uint32_t code) {
        const auto index = static_cast<uint32_t>(items_.size());
        items_.push_back({box, leaf_first(code), kLeaf | leaf_count(code), 1, 0, 0});
        if (is_leaf(code)) return index;
        const Node& node = from_.nodes.data()[code];
        uint32_t child[2];
        for (int c = 0; c < 2; ++c) {
            Bounds child_box;
            const float* const corners = c == 0 ? node.box0 : node.box1;
            child_box.add(corners, corners + 3);
            child[c] = add(child_box, c == 0 ? node.child0 : node.child1);
        }
        items_[index].left = child[0];
        items_[index].right = child[1];
        update(items_[index]);
        return index;
    }

    void update(Item& item) const {
        const Item &left = items_[item.left], &right = items_[item.right];
        item.leaves = left.leaves + right.leaves;
        item.height = std::max(left.height, right.height) + 1;
        item.cost = node_cost_ * half_area(item.box) + left.cost + right.cost;
    }

    // Lists the nodes of at most kPart leaves, and those above them: parents before children.
    void collect(uint32_t index, uint32_t level, std::vector<Job>& jobs, std::vector<Job>& tops) const {
        const Item& item = items_[index];
        if (item.leaves <= kPart) {
            jobs.push_back({index, level});
            return;
        }
        tops.push_back({index, level});
        collect(item.left, level + 1, jobs, tops);
        collect(item.right, level + 1, jobs, tops);
    }

    void optimize_all(uint32_t index, uint32_t level) {
        const Item& item = items_[index];
        if (is_leaf(item.right)) return;
        optimize_all(item.left, level + 1);
        optimize_all(item.right, level + 1);
        optimize(index, level);
    }

    // A treelet: its subtrees, its nodes, and for each set of subtrees the cheapest tree over them.
    struct Treelet {
        uint32_t subtrees[kMost], nodes[kMost - 1], count, node_count;
        Bounds box[kSets];
        double cost[kSets];
        uint32_t height[kSets], left[kSets];  // left: the set of the left child
    };

    // Makes the treelet of a node the cheapest one. All below is optimised already.
    void optimize(uint32_t index, uint32_t level) {
        Treelet t;
        grow(index, t);
        update(items_[index]);
        if (t.count < 3) return;
        const uint32_t all = (1u << t.count) - 1;
        for (uint32_t set = 1; set <= all; ++set) {
            const uint32_t lowest = set & (0u - set), rest = set ^ lowest;
            if (rest == 0) {
                uint32_t i = 0;
                while (set >> i != 1) ++i;
                const Item& subtree = items_[t.subtrees[i]];
                t.box[set] = subtree.box;
                t.cost[set] = subtree.cost;
                t.height[set] = subtree.height;
                continue;
            }
            t.box[set] = t.box[rest];
            t.box[set].add(t.box[lowest]);
            // The lowest subtree is always on the left, so that each division is tried once.
            double best = INFINITY;
            for (uint32_t part = rest; part > 0; part = (part - 1) & rest) {
                const double cost = t.cost[part] + t.cost[set ^ part];
                if (!(cost < best)) continue;
                best = cost;
                t.left[set] = set ^ part;
            }
            t.cost[set] = best + node_cost_ * half_area(t.box[set]);
            t.height[set] = std::max(t.height[t.left[set]], t.height[set ^ t.left[set]]) + 1;
        }
        // Not for rounding errors.
        if (!(t.cost[all] < items_[index].cost * (1 - 1e-6))) return;
        if (t.height[all] > items_[index].height && level + t.height[all] > kMaxDepth) return;
        uint32_t next = 0;
        write(t, all, next);
    }

    // Collects the subtrees: the node with the largest surface is opened until there are enough.
    void grow(uint32_t index, Treelet& t) const {
        t.nodes[0] = index;
        t.node_count = 1;
        t.subtrees[0] = items_[index].left;
        t.subtrees[1] = items_[index].right;
        t.count = 2;
        while (t.count < kMost) {
            uint32_t largest = kMost;
            double area = -1;
            for (uint32_t i = 0; i < t.count; ++i) {
                const Item& item = items_[t.subtrees[i]];
                if (is_leaf(item.right) || !(half_area(item.box) > area)) continue;
                area = half_area(item.box);
                largest = i;
            }
            if (largest == kMost) return;
            const uint32_t opened = t.subtrees[largest];
            t.nodes[t.node_count++] = opened;
            t.subtrees[largest] = items_[opened].left;
            t.subtrees[t.count++] = items_[opened].right;
        }
    }

    // Writes the tree over a set into the treelet's nodes, the root into the first. Returns its item.
    uint32_t write(const Treelet& t, uint32_t set, uint32_t& next) {
        if ((set & (set - 1)) == 0) {
            uint32_t i = 0;
            while (set >> i != 1) ++i;
            return t.subtrees[i];
        }
        const uint32_t index = t.nodes[next++];
        const uint32_t left = write(t, t.left[set], next), right = write(t, set ^ t.left[set], next);
        Item& item = items_[index];
        item.box = t.box[set];
        item.left = left;
        item.right = right;
        update(item);
        return index;
    }

    const Topology& from_;
    const double node_cost_;
    std::vector<Item> items_;
    std::vector<uint32_t> roots_;
};

}  // namespace

Topology optimize_treelets(const rt_host* host, const Topology& from, const uint32_t* old_refs, const TreeletRules& rules,
                           const RefMemory& refs) {
    Optimizer optimizer(from, rules.traversal_cost);
    for (uint32_t p = 0; p < rules.passes; ++p) {
        rt::progress(host, static_cast<float>(p) / static_cast<float>(rules.passes));
        optimizer.pass(host);
    }
    return optimizer.result(host, old_refs, refs);
}

}  // namespace clarity::bvh
