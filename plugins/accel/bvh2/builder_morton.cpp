// builder_morton.cpp -- the builder's steps for primitives that are sorted along a curve.
#include <unordered_map>

#include "builder.hpp"

namespace bvh2 {

// Groups stay apart: the keys of each are sorted for themselves.
void Builder::sort(const std::vector<Pending>& groups) {
    keys_ = std::make_unique<Scratch<MortonKey>>(primitive_count_);
    const Scratch<MortonKey> other(primitive_count_);
    parallel_for(groups.size(), [&](uint32_t g) {
        const Range& group = groups[g].range;
        if (group.count() == 0) return;
        const uint32_t chunks = (group.count() + chunk_size_ - 1) / chunk_size_;
        const auto each = [&](auto&& do_chunk) {
            parallel_for(chunks, [&](uint32_t c) {
                const uint32_t begin = group.begin + c * chunk_size_;
                do_chunk(begin, std::min(begin + chunk_size_, group.end));
            });
        };
        each([&](uint32_t begin, uint32_t end) { make_keys(workspace_, group, begin, end, keys_->data()); });
        sort_keys(host_, keys_->data() + group.begin, other.data() + group.begin, group.count());
        each([&](uint32_t begin, uint32_t end) { gather(workspace_, keys_->data(), begin, end); });
    });
    report(primitive_count_ / 2);
}

void Builder::cut_sorted(const std::vector<Pending>& groups) {
    std::vector<Pending> open = groups;
    while (!open.empty()) {
        Pending at = open.back();
        open.pop_back();
        at.range.buffer = 1;
        if (at.range.count() <= task_size_) {
            if (at.range.count() > 0) add_task(at);
            continue;
        }
        const uint32_t middle = morton_middle(keys_->data(), at.range.begin, at.range.end);
        const rt_u32 node = middle - 1;  // see Workspace::nodes
        put(at, node);
        tree_.tops.push_back({node, scales_[at.group]});
        top_place_.push_back(at);
        ++at.range.depth;
        Pending left = at, right = at;
        left.range.end = right.range.begin = right.room_begin = middle;
        left.parent = right.parent = node;
        left.which = 0;
        right.which = 1;
        open.push_back(right);
        open.push_back(left);
    }
}

// From the tasks up.
void Builder::bound_tops() {
    std::unordered_map<rt_u32, Bounds> boxes;
    const auto put_box = [&](const Pending& place, const Bounds& box) {
        if (place.parent == RT_NONE) return;
        bvh2_node& parent = nodes_.data()[place.parent];
        set_child(parent, static_cast<int>(place.which), box, place.which == 0 ? parent.child0 : parent.child1);
        boxes[place.parent].add(box);
    };
    for (size_t t = 0; t < tree_.tasks.size(); ++t) put_box(task_place_[t], tree_.tasks[t].range.box);
    for (size_t i = tree_.tops.size(); i-- > 0;) {
        const rt_u32 node = tree_.tops[i].node;
        put_box(top_place_[i], boxes[node]);
    }
}

}  // namespace bvh2
