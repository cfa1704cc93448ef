#include "write_nodes.hpp"

#include <algorithm>

#include "rt_plugin.hpp"

namespace bvh2 {
namespace {

class Writer {
 public:
    explicit Writer(const BinaryTree& tree) : tree_(tree), place_(tree.tasks.size()), top_place_(tree.tops.size()) {
        tasks_by_begin_.reserve(tree.tasks.size());
        for (uint32_t t = 0; t < tree.tasks.size(); ++t) tasks_by_begin_.push_back({tree.tasks[t].first_node, t});
        std::sort(tasks_by_begin_.begin(), tasks_by_begin_.end());
        for (uint32_t t = 0; t < tree.tops.size(); ++t) tops_.push_back({tree.tops[t].node, t});
        std::sort(tops_.begin(), tops_.end());
    }

    // Assigns new indices to all nodes below `code`, in depth-first order from `next` on. Returns the next free index.
    rt_u32 place(rt_u32 code, rt_u32 next) {
        if (code & BVH2_LEAF) return next;
        const uint32_t top = top_of(code);
        if (top == RT_NONE) {
            const uint32_t task = task_of(code);
            place_[task] = next;
            return next + tree_.tasks[task].tree.nodes;
        }
        top_place_[top] = next++;
        next = place(tree_.nodes[code].child0, next);
        return place(tree_.nodes[code].child1, next);
    }

    void write_task(uint32_t t, bvh2_node* to) const {
        const Task& task = tree_.tasks[t];
        const bvh2_node* const from = tree_.nodes + task.first_node;
        const rt_u32 shift = place_[t] - task.first_node;
        for (uint32_t i = 0; i < task.tree.nodes; ++i) {
            bvh2_node node = from[i];
            if (!(node.child0 & BVH2_LEAF)) node.child0 += shift;
            if (!(node.child1 & BVH2_LEAF)) node.child1 += shift;
            to[place_[t] + i] = node;
        }
    }

    void write_tops(bvh2_node* to) const {
        for (uint32_t t = 0; t < tree_.tops.size(); ++t) {
            bvh2_node node = tree_.nodes[tree_.tops[t].node];
            node.child0 = code(node.child0);
            node.child1 = code(node.child1);
            to[top_place_[t]] = node;
        }
    }

 private:
    struct Place {
        rt_u32 at;
        uint32_t index;
        bool operator<(const Place& other) const { return at < other.at; }
    };

    rt_u32 code(rt_u32 child) const {
        if (child & BVH2_LEAF) return child;
        const uint32_t top = top_of(child);
        return top != RT_NONE ? top_place_[top] : place_[task_of(child)];
    }
    uint32_t top_of(rt_u32 node) const {
        const auto found = std::lower_bound(tops_.begin(), tops_.end(), Place{node, 0});
        return found != tops_.end() && found->at == node ? found->index : RT_NONE;
    }
    uint32_t task_of(rt_u32 node) const {
        return std::prev(std::upper_bound(tasks_by_begin_.begin(), tasks_by_begin_.end(), Place{node, 0}))->index;
    }

    const BinaryTree& tree_;
    std::vector<rt_u32> place_, top_place_;  // first new index of each task; new index of each top
    std::vector<Place> tasks_by_begin_, tops_;
};

}  // namespace

Written write_nodes(const rt_host* host, const BinaryTree& tree, const rt_build_output* out) {
    Writer writer(tree);
    Written written{nullptr, 0, {}};
    for (const Root& root : tree.roots) {
        written.roots.push_back(written.count);
        const bool is_node = root.code != RT_NONE && !(root.code & BVH2_LEAF);
        written.count = is_node ? writer.place(root.code, written.count) : written.count + 1;
    }
    bvh2_node* const nodes = rt::alloc<bvh2_node>(out, 0, written.count);
    written.nodes = nodes;
    rt::parallel_for(host, static_cast<rt_u32>(tree.tasks.size()), [&](uint32_t t) { writer.write_task(t, nodes); });
    writer.write_tops(nodes);
    Bounds nowhere;
    std::fill_n(nowhere.neg_hi, 4, -FLT_MAX);
    for (uint32_t g = 0; g < tree.roots.size(); ++g) {
        const Root& root = tree.roots[g];
        if (root.code == RT_NONE || root.code & BVH2_LEAF) {
            const bool empty = root.code == RT_NONE;
            set_child(nodes[written.roots[g]], 0, empty ? nowhere : root.box, empty ? BVH2_MAKE_LEAF(0u, 0u) : root.code);
            set_child(nodes[written.roots[g]], 1, nowhere, BVH2_MAKE_LEAF(0u, 0u));
        }
        rt::root(out, g, written.roots[g]);
    }
    return written;
}

}  // namespace bvh2
