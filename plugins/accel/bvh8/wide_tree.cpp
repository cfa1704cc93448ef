#include "wide_tree.hpp"

#include <algorithm>

#include "node_slots.hpp"
#include "rt_plugin.hpp"

namespace bvh8 {

void WideTree::Extent::add(const Extent& child, uint32_t siblings) {
    nodes += child.nodes;
    depth = std::max(depth, child.depth + 1);
    stack = std::max(stack, child.stack + siblings);
}

void WideTree::write(const rt_build_output* out) {
    const std::vector<rt_u32>& binary_roots = collapse_.tree().roots;
    std::vector<rt_u32> codes;
    for (const rt_u32 root : binary_roots) codes.push_back(expand(root));

    std::vector<Extent> extents(jobs_.size());
    rt::parallel_for(host_, static_cast<rt_u32>(jobs_.size()), [&](rt_u32 j) {
        extents[j] = measure(jobs_[j].binary);
        jobs_[j].nodes = extents[j].nodes;
    });
    for (const rt_u32 code : codes) {
        const Extent whole = measure_top(code, extents);
        depth_ = std::max(depth_, whole.depth);
        stack_ = std::max(stack_, whole.stack);
        roots_.push_back(node_count_);
        node_count_ = place(code, node_count_);
    }
    nodes_ = rt::alloc<bvh8_node>(out, 0, node_count_);
    rt::parallel_for(host_, static_cast<rt_u32>(jobs_.size()),
                     [&](rt_u32 j) { write_subtree(jobs_[j].binary, jobs_[j].place); });
    for (const Top& top : tops_) {
        bvh8_node& node = nodes_[top.place];
        clear_node(node);
        uint32_t slot_of[BVH8_WIDTH];
        assign_slots(top.slots, top.count, slot_of);
        for (uint32_t i = 0; i < top.count; ++i) {
            const Slot& slot = top.slots[i];
            set_slot(node, slot_of[i], slot.box, slot.leaf != BVH8_NOTHING ? slot.leaf : place_of(top.below[i]));
        }
    }
    for (rt_u32 g = 0; g < roots_.size(); ++g) rt::root(out, g, roots_[g]);
}

// Of a node of the binary tree that becomes one of the wide tree: the jobs below it, and what lies above them.
rt_u32 WideTree::expand(rt_u32 binary) {
    if (!collapse_.is_above_tasks(binary)) {
        jobs_.push_back({binary});
        return static_cast<rt_u32>(jobs_.size() - 1) | kJob;
    }
    const auto index = static_cast<rt_u32>(tops_.size());
    tops_.emplace_back();
    Top top;
    top.count = collapse_.children(binary, top.slots);
    for (uint32_t i = 0; i < top.count; ++i)
        if (top.slots[i].leaf == BVH8_NOTHING) top.below[i] = expand(top.slots[i].binary);
    tops_[index] = top;
    return index;
}

WideTree::Extent WideTree::measure(rt_u32 binary) const {
    Slot slots[BVH8_WIDTH];
    const uint32_t count = collapse_.children(binary, slots);
    Extent extent;
    extent.stack = count;
    for (uint32_t i = 0; i < count; ++i)
        if (slots[i].leaf == BVH8_NOTHING) extent.add(measure(slots[i].binary), count - 1);
    return extent;
}

WideTree::Extent WideTree::measure_top(rt_u32 code, const std::vector<Extent>& jobs) const {
    if (code & kJob) return jobs[code & ~kJob];
    const Top& top = tops_[code];
    Extent extent;
    extent.stack = top.count;
    for (uint32_t i = 0; i < top.count; ++i)
        if (top.slots[i].leaf == BVH8_NOTHING) extent.add(measure_top(top.below[i], jobs), top.count - 1);
    return extent;
}

// Gives the nodes their places, parents before children, from `next` on; returns the next free one.
rt_u32 WideTree::place(rt_u32 code, rt_u32 next) {
    if (code & kJob) {
        Job& job = jobs_[code & ~kJob];
        job.place = next;
        return next + job.nodes;
    }
    tops_[code].place = next++;
    for (uint32_t i = 0; i < tops_[code].count; ++i)
        if (tops_[code].slots[i].leaf == BVH8_NOTHING) next = place(tops_[code].below[i], next);
    return next;
}

// Depth-first; returns the next free place.
rt_u32 WideTree::write_subtree(rt_u32 binary, rt_u32 at) const {
    Slot slots[BVH8_WIDTH];
    uint32_t slot_of[BVH8_WIDTH];
    const uint32_t count = collapse_.children(binary, slots);
    assign_slots(slots, count, slot_of);
    bvh8_node& node = nodes_[at];
    clear_node(node);
    rt_u32 next = at + 1;
    for (uint32_t i = 0; i < count; ++i) {
        set_slot(node, slot_of[i], slots[i].box, slots[i].leaf != BVH8_NOTHING ? slots[i].leaf : next);
        if (slots[i].leaf == BVH8_NOTHING) next = write_subtree(slots[i].binary, next);
    }
    return next;
}

}  // namespace bvh8
