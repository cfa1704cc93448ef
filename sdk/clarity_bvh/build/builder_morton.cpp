// builder_morton.cpp -- builds the binary tree from primitives sorted along a space-filling curve.
#include "clarity_bvh/build/builder.hpp"
#include "clarity_bvh/build/sorted_run.hpp"

namespace clarity::bvh {
namespace {

// Copies a tree from children-first order to depth-first order. Returns the index after its last node.
rt_u32 write_depth_first(const Node* from, rt_u32 node, Node* to, rt_u32 at) {
    rt_u32 next = at + 1;
    to[at] = from[node];
    for (rt_u32* child : {&to[at].child0, &to[at].child1}) {
        if (is_leaf(*child)) continue;
        const rt_u32 below = *child;
        *child = next;
        next = write_depth_first(from, below, to, next);
    }
    return next;
}

}  // namespace

void TopologyBuilder::build_sorted(const std::function<void(const Part&)>& after) {
    const MortonOrder order(host_, input_, primitive_count_);
    for (const MortonOrder::Group& group : order.groups()) {
        tree_.roots[scales_.size()].box = group.box;
        scales_.push_back(unit_scale(group.box));
    }
    report(primitive_count_);
    for (const MortonOrder::Run& run : order.runs()) {
        Pending pending{{}, RT_NONE, 0, run.group, run.begin, run.end};
        pending.range.begin = run.begin;
        pending.range.end = run.end;
        add_task(pending);
    }
    run_tasks([&](uint32_t t) {
        Part& part = tree_.parts[t];
        const MortonOrder::Run& run = order.runs()[t];
        const Scratch<Node> nodes(run.count());
        const SortedSubtree root =
            sweep(order.sort(run), run.count(), order.prims(run.group), run.begin, workspace_.rules.max_leaf,
                  workspace_.leaves + run.begin, nodes.data(), part.node_count);
        part.root = root.code;
        if (part.node_count > 0) {
            write_depth_first(nodes.data(), root.code, tree_nodes_, run.begin);
            part.root = run.begin;
        }
        part.depth = run.depth + root.depth;
        store(tasks_[t].range.box.lo, root.lo);
        store(tasks_[t].range.box.neg_hi, root.neg_hi);
        after(part);
    });

    // The nodes above the runs, from the bottom up.
    std::vector<Bounds> boxes(order.tops().size());
    const auto node_of = [&](rt_u32 code) {
        return code & MortonOrder::kRun ? tree_.parts[code & ~MortonOrder::kRun].root
                                        : order.tops()[code].middle - 1;  // see Workspace::nodes
    };
    const auto box_of = [&](rt_u32 code) -> const Bounds& {
        return code & MortonOrder::kRun ? tasks_[code & ~MortonOrder::kRun].range.box : boxes[code];
    };
    for (size_t t = order.tops().size(); t-- > 0;) {
        const MortonOrder::Top& top = order.tops()[t];
        for (int c = 0; c < 2; ++c) {
            set_child(tree_nodes_[top.middle - 1], c, box_of(top.child[c]), node_of(top.child[c]));
            boxes[t].add(box_of(top.child[c]));
        }
    }
    for (const MortonOrder::Top& top : order.tops()) tree_.tops.push_back({top.middle - 1, scales_[top.group]});
    for (size_t g = 0; g < tree_.roots.size(); ++g)
        if (const rt_u32 code = order.groups()[g].code; code != RT_NONE) tree_.roots[g].code = node_of(code);
}

}  // namespace clarity::bvh
