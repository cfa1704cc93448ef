#include "wide_tree.hpp"

#include <algorithm>

#include "node_memory.hpp"
#include "node_slots.hpp"
#include "rt_plugin.hpp"

namespace bvh8 {
namespace {

double area(const float box[6]) {
    const double x = double{box[3]} - box[0], y = double{box[4]} - box[1], z = double{box[5]} - box[2];
    return 2 * (x * y + y * z + z * x);
}

}  // namespace

void Sums::add(const Slot* slots, uint32_t count) {
    children += count;
    for (uint32_t i = 0; i < count; ++i) {
        if (slots[i].leaf == BVH8_EMPTY) {
            node_area += area(slots[i].box);
        } else {
            ++leaves;
            primitive_area += area(slots[i].box) * BVH8_LEAF_COUNT(slots[i].leaf);
        }
    }
}

void Sums::add(const Sums& other) {
    leaves += other.leaves;
    children += other.children;
    node_area += other.node_area;
    primitive_area += other.primitive_area;
}

void Extent::add(const Extent& child, uint32_t siblings) {
    nodes += child.nodes;
    depth = std::max(depth, child.depth + 1);
    stack = std::max(stack, child.stack + siblings);
}

void WideTree::write(const rt_build_output* out) {
    const auto group_count = static_cast<rt_u32>(groups_.size());
    std::vector<rt_u32> codes, roots;
    root_boxes_.resize(group_count);
    for (rt_u32 g = 0; g < group_count; ++g) codes.push_back(expand_root(g));

    std::vector<Extent> extents(jobs_.size());
    const auto measure = [&](rt_u32 j) {
        extents[j] = subtrees_.measure(jobs_[j].binary);
        jobs_[j].nodes = extents[j].nodes;
    };
    if (subtrees_.measured())
        for (rt_u32 j = 0; j < jobs_.size(); ++j) measure(j);
    else
        rt::parallel_for(host_, static_cast<rt_u32>(jobs_.size()), measure);
    for (const rt_u32 code : codes) {
        const Extent whole = measure_top(code, extents);
        depth_ = std::max(depth_, whole.depth);
        stack_ = std::max(stack_, whole.stack);
        roots.push_back(node_count_);
        node_count_ = place(code, node_count_);
    }
    nodes_ = rt::alloc<bvh8_node>(out, 0, node_count_);
    rt::parallel_for(host_, static_cast<rt_u32>(jobs_.size()),
                     [&](rt_u32 j) { subtrees_.write(jobs_[j].binary, nodes_, jobs_[j].place, jobs_[j].sums); });
    for (const Top& top : tops_) {
        rt_u32 below[BVH8_WIDTH];
        for (uint32_t i = 0; i < top.count; ++i)
            below[i] = top.slots[i].leaf != BVH8_EMPTY ? top.slots[i].leaf : place_of(top.below[i]);
        write_node(nodes_[top.place], top.slots, below, top.count);
        settle(nodes_, top.place);
    }
    for (rt_u32 g = 0; g < group_count; ++g) rt::root(out, g, roots[g]);
}

rt_u32 WideTree::expand_root(rt_u32 group) {
    const bvh2::Root& root = groups_[group];
    if (root.code != RT_NONE && !(root.code & BVH2_LEAF)) return expand(root.code, group);
    Top top;
    top.group = group;
    if (root.code != RT_NONE) {
        for (int a = 0; a < 3; ++a) {
            root_boxes_[group][a] = root.box.lo[a];
            root_boxes_[group][3 + a] = root.box.hi(a);
        }
        top.slots[top.count++] = {root_boxes_[group].data(),
                                  BVH8_MAKE_LEAF(BVH2_LEAF_FIRST(root.code), BVH2_LEAF_COUNT(root.code)), 0};
    }
    tops_.push_back(top);
    return static_cast<rt_u32>(tops_.size() - 1);
}

// Collects the jobs and tops of the wide node that is made from a binary node. Returns its index in tops_, or in jobs_ with
// kJob.
rt_u32 WideTree::expand(rt_u32 binary, rt_u32 group) {
    if (!collapse_.is_above_tasks(binary)) {
        jobs_.push_back({binary, group, 0, 0, {}});
        return static_cast<rt_u32>(jobs_.size() - 1) | kJob;
    }
    const auto index = static_cast<rt_u32>(tops_.size());
    tops_.emplace_back();
    Top top;
    top.group = group;
    top.count = collapse_.children(binary, top.slots);
    for (uint32_t i = 0; i < top.count; ++i)
        if (top.slots[i].leaf == BVH8_EMPTY) top.below[i] = expand(top.slots[i].binary, group);
    tops_[index] = top;
    return index;
}

Extent CollapsedSubtrees::measure(rt_u32 binary) const {
    Slot slots[BVH8_WIDTH];
    const uint32_t count = collapse_.children(binary, slots);
    Extent extent;
    extent.stack = count;
    for (uint32_t i = 0; i < count; ++i)
        if (slots[i].leaf == BVH8_EMPTY) extent.add(measure(slots[i].binary), count - 1);
    return extent;
}

Extent WideTree::measure_top(rt_u32 code, const std::vector<Extent>& jobs) const {
    if (code & kJob) return jobs[code & ~kJob];
    const Top& top = tops_[code];
    Extent extent;
    extent.stack = top.count;
    for (uint32_t i = 0; i < top.count; ++i)
        if (top.slots[i].leaf == BVH8_EMPTY) extent.add(measure_top(top.below[i], jobs), top.count - 1);
    return extent;
}

// Assigns node indices in depth-first order from `next` on, parents before children. Returns the next free index.
rt_u32 WideTree::place(rt_u32 code, rt_u32 next) {
    if (code & kJob) {
        Job& job = jobs_[code & ~kJob];
        job.place = next;
        return next + job.nodes;
    }
    tops_[code].place = next++;
    for (uint32_t i = 0; i < tops_[code].count; ++i)
        if (tops_[code].slots[i].leaf == BVH8_EMPTY) next = place(tops_[code].below[i], next);
    return next;
}

// Writes the subtree depth-first. Returns the next free index.
rt_u32 CollapsedSubtrees::write_subtree(rt_u32 binary, bvh8_node* nodes, rt_u32 at, Sums& sums) const {
    Slot slots[BVH8_WIDTH];
    const uint32_t count = collapse_.children(binary, slots);
    sums.add(slots, count);
    rt_u32 below[BVH8_WIDTH], next = at + 1;
    for (uint32_t i = 0; i < count; ++i) {
        below[i] = slots[i].leaf != BVH8_EMPTY ? slots[i].leaf : next;
        if (slots[i].leaf == BVH8_EMPTY) next = write_subtree(slots[i].binary, nodes, next, sums);
    }
    write_node(nodes[at], slots, below, count);
    settle(nodes, at);
    return next;
}

Statistics WideTree::statistics(const rt_group* groups) const {
    std::vector<Sums> of_group(groups_.size());
    for (const Top& top : tops_) {
        Sums sums;
        sums.add(top.slots, top.count);
        of_group[top.group].add(sums);
    }
    for (const Job& job : jobs_) of_group[job.group].add(job.sums);
    Statistics result;
    double cost = 0, primitives = 0;
    for (size_t g = 0; g < of_group.size(); ++g) {
        result.leaves += of_group[g].leaves;
        result.children += of_group[g].children;
        if (groups_[g].code == RT_NONE) continue;
        const bvh2::Bounds& box = groups_[g].box;
        const float whole_box[6] = {box.lo[0], box.lo[1], box.lo[2], box.hi(0), box.hi(1), box.hi(2)};
        const double whole = area(whole_box);
        if (!(whole > 0)) continue;  // no ray hits a point or a line
        cost +=
            groups[g].count *
            (double{costs_.node} * (whole + of_group[g].node_area) + double{costs_.primitive} * of_group[g].primitive_area) /
            whole;
        primitives += groups[g].count;
    }
    result.sah_cost = primitives > 0 ? cost / primitives : 0;
    return result;
}

}  // namespace bvh8
