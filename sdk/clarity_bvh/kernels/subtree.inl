// subtree.inl -- builds the tree of one range on one thread, without allocating.
// Each kernels*.cpp includes this file once, for its instruction set.

namespace clarity::bvh {
namespace CLARITY_BVH_ISA {
namespace {

class Builder {
 public:
    Builder(const Workspace& workspace, const Range& range, uint32_t first_node, uint32_t first_leaf)
        : w_(workspace), next_(first_node), leaf_shift_(first_leaf - range.begin) {}

    Subtree build(const Range& range) {
        Subtree result;
        const uint32_t first = next_;
        result.root = build_range(range);
        result.nodes = next_ - first;
        result.depth = depth_;
        return result;
    }

 private:
    uint32_t build_range(const Range& range) {
        const uint32_t count = range.count();
        if (count <= kSmall && !w_.rules.halves && range.depth + count <= kMaxDepth)
            return build_small(w_.records[range.buffer] + range.begin, range.begin, count, range.depth, range.box);
        Range left, right;
        const AreaScale area(range.box);
        if (count == 1 || !split(range, area, left, right)) return make_range_leaf(w_.records[range.buffer], range);
        if (right_is_larger(area, left, right)) std::swap(left, right);
        const uint32_t at = next_++;
        Node& node = w_.nodes[at];
        set_child(node, 0, left.box, 0);
        set_child(node, 1, right.box, 0);
        node.child0 = build_range(left);
        node.child1 = build_range(right);
        return at;
    }

    // Splits a range and moves its records to the two parts. Returns false if the range should become a leaf.
    bool split(const Range& range, const AreaScale& area, Range& left, Range& right) {
        const uint32_t count = range.count();
        Record* const from = w_.records[range.buffer];
        if (may_bin(w_.rules, range)) {
            const uint32_t bin_count = bins_for(w_.rules, count);
            const Slices slices(range.centroids2, bin_count);
            clear(bins_, bin_count);
            bin(from + range.begin, from + range.end, slices, bins_);
            Split found;
            find_split(bins_, bin_count, area, count, found);
            if (leaf_is_better(count, area.half_area(range.box), found.cost)) return false;
            if (found.cost < INFINITY) {
                Record* const to = w_.records[range.buffer ^ 1];
                begin_split(range, found, left, right);
                scatter(from + range.begin, from + range.end, slices, found, to + left.begin, to + right.begin,
                        left.centroids2, right.centroids2);
                return true;
            }
        }
        if (count <= w_.rules.max_leaf) return false;
        halve(from, range, left, right);
        return true;
    }

    // Builds the tree of at most kSmall records, and reorders them in place. `first` is the position of the first record in its
    // buffer.
    uint32_t build_small(Record* records, uint32_t first, uint32_t count, uint32_t depth, const Bounds& box) {
        if (count == 1) return make_small_leaf(records, first, 1, depth);
        const AreaScale area(box);
        if (count == 2) return build_pair(records, first, depth, area.half_area(box), area);
        SmallSplit split;
        split_small(records, count, box, area, split);
        if (leaf_is_better(count, area.half_area(box), split.cost) ||
            (!(split.cost < INFINITY) && count <= w_.rules.max_leaf))
            return make_small_leaf(records, first, count, depth);
        if (split.left_count == 0) split.left_count = count / 2;  // the areas are NaN
        Record sorted[kSmall];
        for (uint32_t i = 0; i < count; ++i) copy(sorted + i, records[split.order[i][split.axis]]);
        Box8 left = no_box(), right = no_box();
        for (uint32_t i = 0; i < split.left_count; ++i) left = min(left, box_of(sorted[i]));
        for (uint32_t i = split.left_count; i < count; ++i) right = min(right, box_of(sorted[i]));
        for (uint32_t i = 0; i < count; ++i) copy(records + i, sorted[i]);
        Bounds side[2];
        store_box(side[0], left);
        store_box(side[1], right);
        const uint32_t begin[2] = {0, split.left_count}, size[2] = {split.left_count, count - split.left_count};
        const uint32_t large = area.half_area(side[0]) < area.half_area(side[1]), small = large ^ 1;
        const uint32_t at = next_++;
        Node& node = w_.nodes[at];
        set_child(node, 0, side[large], 0);
        set_child(node, 1, side[small], 0);
        node.child0 = build_small(records + begin[large], first + begin[large], size[large], depth + 1, side[large]);
        node.child1 = build_small(records + begin[small], first + begin[small], size[small], depth + 1, side[small]);
        return at;
    }

    uint32_t build_pair(const Record* records, uint32_t first, uint32_t depth, float half_area, const AreaScale& area) {
        Bounds side[2];
        store_box(side[0], box_of(records[0]));
        store_box(side[1], box_of(records[1]));
        const float a = area.half_area(side[0]), b = area.half_area(side[1]);
        if (leaf_is_better(2, half_area, a + b)) return make_small_leaf(records, first, 2, depth);
        const uint32_t large = a < b;
        const uint32_t at = next_++;
        set_child(w_.nodes[at], 0, side[large], make_small_leaf(records + large, first + large, 1, depth + 1));
        set_child(w_.nodes[at], 1, side[large ^ 1], make_small_leaf(records + (large ^ 1), first + (large ^ 1), 1, depth + 1));
        return at;
    }

    static void set_child(Node& node, int which, const Bounds& box, uint32_t child) {
        float* const out = which == 0 ? node.box0 : node.box1;
        store_any(out, load(box.lo));
        alignas(16) float hi[4];
        store(hi, splat(0.0f) - load(box.neg_hi));
        std::memcpy(out + 3, hi, 3 * sizeof hi[0]);
        (which == 0 ? node.child0 : node.child1) = child;
        (which == 0 ? node.work0 : node.work1) = 0;
    }

    // half_area is that of the range; split_cost is as in Split.
    bool leaf_is_better(uint32_t count, float half_area, float split_cost) const {
        if (count > w_.rules.max_leaf) return false;
        const float as_leaf = w_.rules.intersection_cost * static_cast<float>(count) * half_area;
        return !(w_.rules.traversal_cost * half_area + w_.rules.intersection_cost * split_cost < as_leaf);
    }

    uint32_t make_range_leaf(const Record* records, const Range& range) {
        return make_small_leaf(records + range.begin, range.begin, range.count(), range.depth);
    }
    uint32_t make_small_leaf(const Record* records, uint32_t first, uint32_t count, uint32_t depth) {
        first += leaf_shift_;
        for (uint32_t i = 0; i < count; ++i) w_.leaves[first + i] = records[i].ref();
        depth_ = std::max(depth_, depth);
        return make_leaf(first, count);
    }

    const Workspace& w_;
    uint32_t next_;  // index of the next free node
    const uint32_t leaf_shift_;  // added to a record's position gives its position in leaf order
    uint32_t depth_ = 0;
    Bins bins_;
};

Subtree build_subtree(const Workspace& workspace, const Range& range, uint32_t first_node, uint32_t first_leaf) {
    return Builder(workspace, range, first_node, first_leaf).build(range);
}

void share_roots(const float left[kRoots], const float right[2 * kRoots], SharedRoots& shared) {
    Box8 cost = all_eight(INFINITY), lefts = all_eight(0.0f);
    for (uint32_t l = 1; l < kRoots; ++l)
        keep_less(all_eight(left[l - 1]) + load_eight(right + kRoots - l), all_eight(static_cast<float>(l)), cost, lefts);
    store_box(shared.cost, cost);
    store_box(shared.left, lefts);
}

void assign_places(Suits suits[], uint32_t count, uint32_t place_of[]) {
    Box8 open = all_eight(FLT_MAX);  // upper limit per place: FLT_MAX if the place is free, -FLT_MAX if taken
    for (uint32_t left = count; left > 0; --left) {
        Box8 even = load_box(suits[0].place), odd = all_eight(-FLT_MAX);
        for (uint32_t i = 1; i + 1 < count; i += 2) {
            odd = max(odd, load_box(suits[i].place));
            even = max(even, load_box(suits[i + 1].place));
        }
        if (count % 2 == 0) odd = max(odd, load_box(suits[count - 1].place));
        const Box8 best_of_place = min(max(even, odd), open), best = highest(best_of_place);
        uint32_t tag;
        alignas(32) float values[kPlaces];
        store_box(values, best);
        std::memcpy(&tag, values, sizeof tag);
        tag %= kTags;
        place_of[tag / kPlaces] = tag % kPlaces;
        open = min_unless(less(best_of_place, best), all_eight(-FLT_MAX), open);
        store_box(suits[tag / kPlaces].place, all_eight(-FLT_MAX));
    }
}

}  // namespace

const Kernels kernels = {clear, bin, merge, find_split, scatter, build_subtree, share_roots, assign_places};

}  // namespace CLARITY_BVH_ISA
}  // namespace clarity::bvh
