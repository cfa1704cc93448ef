#include "clarity_bvh/pack_binary.hpp"

#include <algorithm>
#include <iterator>

namespace clarity::bvh {

BinaryOrder::BinaryOrder(const Topology& topology)
    : topology_(topology), part_place_(topology.parts.size()), top_place_(topology.tops.size()) {
    parts_.reserve(topology.parts.size());
    for (uint32_t p = 0; p < topology.parts.size(); ++p) parts_.push_back({topology.parts[p].first_node, p});
    std::sort(parts_.begin(), parts_.end());
    tops_.reserve(topology.tops.size());
    for (uint32_t t = 0; t < topology.tops.size(); ++t) tops_.push_back({topology.tops[t].node, t});
    std::sort(tops_.begin(), tops_.end());
    for (const Root& root : topology.roots) {
        roots_.push_back(count_);
        const bool is_node = root.code != RT_NONE && !is_leaf(root.code);
        count_ = is_node ? assign(root.code, count_) : count_ + 1;
    }
}

// Assigns places to all nodes below `code`, in depth-first order from `next` on. Returns the next free place.
uint32_t BinaryOrder::assign(uint32_t code, uint32_t next) {
    if (is_leaf(code)) return next;
    const uint32_t top = top_of(code);
    if (top == RT_NONE) {
        const uint32_t part = part_of(code);
        part_place_[part] = next;
        return next + topology_.parts[part].node_count;
    }
    top_place_[top] = next++;
    next = assign(topology_.nodes.data()[code].child0, next);
    return assign(topology_.nodes.data()[code].child1, next);
}

uint32_t BinaryOrder::place_of(uint32_t code) const {
    if (is_leaf(code)) return code;
    const uint32_t top = top_of(code);
    return top != RT_NONE ? top_place_[top] : part_place_[part_of(code)];
}

uint32_t BinaryOrder::top_of(uint32_t node) const {
    const auto found = std::lower_bound(tops_.begin(), tops_.end(), Place{node, 0});
    return found != tops_.end() && found->at == node ? found->index : RT_NONE;
}

uint32_t BinaryOrder::part_of(uint32_t node) const {
    return std::prev(std::upper_bound(parts_.begin(), parts_.end(), Place{node, 0}))->index;
}

}  // namespace clarity::bvh
