#include "clarity_bvh/wide/wide_tree.hpp"

#include <algorithm>

#include "rt_plugin.hpp"

namespace clarity::bvh {

void WideSums::add(const Slot* slots, uint32_t count) {
    children += count;
    for (uint32_t i = 0; i < count; ++i) {
        if (slots[i].leaf == kEmpty) {
            surfaces.add_node(rt::surface_of(slots[i].box));
        } else {
            ++leaves;
            surfaces.add_leaf(rt::surface_of(slots[i].box), leaf_count(slots[i].leaf));
        }
    }
}

void WideSums::add(const WideSums& other) {
    leaves += other.leaves;
    children += other.children;
    surfaces.add(other.surfaces);
}

void WideExtent::add(const WideExtent& child, uint32_t siblings) {
    nodes += child.nodes;
    depth = std::max(depth, child.depth + 1);
    stack = std::max(stack, child.stack + siblings);
}

template <uint32_t Width>
void WideTree<Width>::write(const WideOutput<Width>& out) {
    const auto group_count = static_cast<uint32_t>(groups_.size());
    std::vector<uint32_t> codes, roots;
    root_boxes_.resize(group_count);
    for (uint32_t g = 0; g < group_count; ++g) codes.push_back(expand_root(g));

    std::vector<WideExtent> extents(jobs_.size());
    const auto measure = [&](uint32_t j) {
        extents[j] = subtrees_.measure(jobs_[j].binary);
        jobs_[j].nodes = extents[j].nodes;
    };
    if (subtrees_.measured())
        for (uint32_t j = 0; j < jobs_.size(); ++j) measure(j);
    else
        rt::parallel_for(host_, static_cast<rt_u32>(jobs_.size()), measure);
    for (const uint32_t code : codes) {
        const WideExtent whole = measure_top(code, extents);
        depth_ = std::max(depth_, whole.depth);
        stack_ = std::max(stack_, whole.stack);
        roots.push_back(node_count_);
        node_count_ = place(code, node_count_);
    }
    nodes_ = out.nodes(node_count_);
    rt::parallel_for(host_, static_cast<uint32_t>(jobs_.size()),
                     [&](uint32_t j) { subtrees_.write(jobs_[j].binary, nodes_, jobs_[j].place, jobs_[j].sums); });
    for (const Above& top : tops_) {
        uint32_t below[Width];
        for (uint32_t i = 0; i < top.count; ++i)
            below[i] = top.slots[i].leaf != kEmpty ? top.slots[i].leaf : place_of(top.below[i]);
        layout_.write(nodes_[top.place], top.slots, below, top.count);
        if (layout_.settle) layout_.settle(nodes_, top.place);
    }
    for (uint32_t g = 0; g < group_count; ++g) out.root(g, roots[g]);
}

template <uint32_t Width>
uint32_t WideTree<Width>::expand_root(uint32_t group) {
    const Root& root = groups_[group];
    if (root.code != RT_NONE && !is_leaf(root.code)) return expand(root.code, group);
    Above top;
    top.group = group;
    if (root.code != RT_NONE) {
        for (int a = 0; a < 3; ++a) {
            root_boxes_[group][a] = root.box.lo[a];
            root_boxes_[group][3 + a] = root.box.hi(a);
        }
        top.slots[top.count++] = {root_boxes_[group].data(), root.code, 0};
    }
    tops_.push_back(top);
    return static_cast<uint32_t>(tops_.size() - 1);
}

// Collects the jobs and tops of the wide node that is made from a binary node. Returns its index in tops_, or in jobs_ with
// kJob.
template <uint32_t Width>
uint32_t WideTree<Width>::expand(uint32_t binary, uint32_t group) {
    if (!collapse_.is_above_parts(binary)) {
        jobs_.push_back({binary, group, 0, 0, {}});
        return static_cast<uint32_t>(jobs_.size() - 1) | kJob;
    }
    const auto index = static_cast<uint32_t>(tops_.size());
    tops_.emplace_back();
    Above top;
    top.group = group;
    top.count = collapse_.children(binary, top.slots);
    for (uint32_t i = 0; i < top.count; ++i)
        if (top.slots[i].leaf == kEmpty) top.below[i] = expand(top.slots[i].binary, group);
    tops_[index] = top;
    return index;
}

template <uint32_t Width>
WideExtent CollapsedSubtrees<Width>::measure(uint32_t binary) const {
    Slot slots[Width];
    const uint32_t count = collapse_.children(binary, slots);
    WideExtent extent;
    extent.stack = count;
    for (uint32_t i = 0; i < count; ++i)
        if (slots[i].leaf == kEmpty) extent.add(measure(slots[i].binary), count - 1);
    return extent;
}

template <uint32_t Width>
WideExtent WideTree<Width>::measure_top(uint32_t code, const std::vector<WideExtent>& jobs) const {
    if (code & kJob) return jobs[code & ~kJob];
    const Above& top = tops_[code];
    WideExtent extent;
    extent.stack = top.count;
    for (uint32_t i = 0; i < top.count; ++i)
        if (top.slots[i].leaf == kEmpty) extent.add(measure_top(top.below[i], jobs), top.count - 1);
    return extent;
}

// Assigns node indices in depth-first order from `next` on, parents before children. Returns the next free index.
template <uint32_t Width>
uint32_t WideTree<Width>::place(uint32_t code, uint32_t next) {
    if (code & kJob) {
        Job& job = jobs_[code & ~kJob];
        job.place = next;
        return next + job.nodes;
    }
    tops_[code].place = next++;
    for (uint32_t i = 0; i < tops_[code].count; ++i)
        if (tops_[code].slots[i].leaf == kEmpty) next = place(tops_[code].below[i], next);
    return next;
}

// Writes the subtree depth-first. Returns the next free index.
template <uint32_t Width>
uint32_t CollapsedSubtrees<Width>::write_subtree(uint32_t binary, WideNode<Width>* nodes, uint32_t at, WideSums& sums) const {
    Slot slots[Width];
    const uint32_t count = collapse_.children(binary, slots);
    sums.add(slots, count);
    uint32_t below[Width], next = at + 1;
    for (uint32_t i = 0; i < count; ++i) {
        below[i] = slots[i].leaf != kEmpty ? slots[i].leaf : next;
        if (slots[i].leaf == kEmpty) next = write_subtree(slots[i].binary, nodes, next, sums);
    }
    layout_.write(nodes[at], slots, below, count);
    if (layout_.settle) layout_.settle(nodes, at);
    return next;
}

template <uint32_t Width>
WideStatistics WideTree<Width>::statistics(const rt_group* groups) const {
    std::vector<WideSums> of_group(groups_.size());
    for (const Above& top : tops_) {
        WideSums sums;
        sums.add(top.slots, top.count);
        of_group[top.group].add(sums);
    }
    for (const Job& job : jobs_) of_group[job.group].add(job.sums);
    WideStatistics result;
    for (size_t g = 0; g < of_group.size(); ++g) {
        result.leaves += of_group[g].leaves;
        result.children += of_group[g].children;
        if (groups_[g].code == RT_NONE) continue;
        const Bounds& box = groups_[g].box;
        const float lo[3] = {box.lo[0], box.lo[1], box.lo[2]}, hi[3] = {box.hi(0), box.hi(1), box.hi(2)};
        const double whole = rt::surface_of(lo, hi);
        of_group[g].surfaces.add_node(whole);  // the root
        result.expected.add_group(groups[g].count, whole, of_group[g].surfaces);
    }
    result.sah_cost = result.expected.weighted(costs_.node, costs_.primitive);
    return result;
}

template class CollapsedSubtrees<4>;
template class CollapsedSubtrees<8>;
template class WideTree<4>;
template class WideTree<8>;

}  // namespace clarity::bvh
