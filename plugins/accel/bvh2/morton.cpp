#include "morton.hpp"

#include <utility>
#include <vector>

#include "rt_plugin.hpp"

namespace bvh2 {
namespace {

constexpr unsigned kAxisBits = 12, kDigitBits = 9, kDigits = 1u << kDigitBits;
constexpr uint64_t kSortChunk = 1u << 15;

// Two zero bits behind every one of the low 12.
uint64_t spread(uint64_t x) {
    x = (x | x << 16) & 0x0000FF0000FFull;
    x = (x | x << 8) & 0x00F00F00F00Full;
    x = (x | x << 4) & 0x0C30C30C30C3ull;
    return (x | x << 2) & 0x249249249249ull;
}

class Builder {
 public:
    Builder(const Workspace& workspace, const MortonKey* keys, uint32_t first_node)
        : w_(workspace), keys_(keys), next_(first_node) {}

    uint32_t build(uint32_t begin, uint32_t end, uint32_t depth, Bounds& box) {
        if (end - begin <= w_.rules.max_leaf) return make_leaf(begin, end, depth, box);
        const uint32_t middle = morton_middle(keys_, begin, end), at = next_++;
        Bounds left, right;
        const uint32_t child0 = build(begin, middle, depth + 1, left), child1 = build(middle, end, depth + 1, right);
        set_child(w_.nodes[at], 0, left, child0);
        set_child(w_.nodes[at], 1, right, child1);
        box = left;
        box.add(right);
        return at;
    }
    uint32_t next_node() const { return next_; }
    uint32_t depth() const { return depth_; }

 private:
    uint32_t make_leaf(uint32_t begin, uint32_t end, uint32_t depth, Bounds& box) {
        const Record* const records = w_.records[1];
        Vec4 lo = splat(FLT_MAX), neg_hi = lo;
        for (uint32_t i = begin; i < end; ++i) {
            w_.leaves[i] = records[i].ref();
            lo = min(lo, xyz(load(records[i].lo)));
            neg_hi = min(neg_hi, load(records[i].neg_hi));
        }
        store(box.lo, lo);
        store(box.neg_hi, neg_hi);
        depth_ = std::max(depth_, depth);
        return BVH2_MAKE_LEAF(begin, end - begin);
    }

    const Workspace& w_;
    const MortonKey* const keys_;
    uint32_t next_, depth_ = 0;
};

}  // namespace

void make_keys(const Workspace& workspace, const Range& group, uint32_t begin, uint32_t end, MortonKey* keys) {
    // Halves, since sums of two bounds may overflow; an axis without extent has all in cell 0.
    const Vec4 half = splat(0.5f), base = xyz(load(group.centroids2.lo)) * half;
    const Vec4 extent = splat(0.0f) - (base + xyz(load(group.centroids2.neg_hi)) * half);
    constexpr float kCells = 1u << kAxisBits;
    const Vec4 scale = min(splat(kCells) / extent, splat(FLT_MAX)), last = splat(kCells - 1);
    for (uint32_t i = begin; i < end; ++i) {
        const Record& r = workspace.records[0][i];
        const Vec4 centroid = xyz(load(r.lo)) * half - load(r.neg_hi) * half;
        uint32_t cell[3];
        to_index(max(min((centroid - base) * scale, last), splat(0.0f)), cell);
        const uint64_t place = spread(cell[0]) << 2 | spread(cell[1]) << 1 | spread(cell[2]);
        keys[i] = place << kPositionBits | i;
    }
}

// Least significant digits first; every pass counts and moves chunks in parallel, in an order that does not depend on threads.
void sort_keys(const rt_host* host, MortonKey* keys, MortonKey* other, uint64_t count) {
    struct Counts {
        uint32_t of[kDigits];
    };
    const auto chunk_count = static_cast<rt_u32>((count + kSortChunk - 1) / kSortChunk);
    std::vector<Counts> counts(chunk_count);
    MortonKey *from = keys, *to = other;
    for (unsigned shift = kPositionBits; shift < 64; shift += kDigitBits) {
        const auto digit = [shift](MortonKey key) { return key >> shift & (kDigits - 1); };
        const auto each = [&](rt_u32 c, auto&& do_one) {
            for (uint64_t i = c * kSortChunk; i < std::min(count, (c + 1) * kSortChunk); ++i) do_one(from[i]);
        };
        rt::parallel_for(host, chunk_count, [&](rt_u32 c) {
            std::fill_n(counts[c].of, kDigits, 0u);
            each(c, [&](MortonKey key) { ++counts[c].of[digit(key)]; });
        });
        uint32_t place = 0;
        for (unsigned d = 0; d < kDigits; ++d)
            for (Counts& chunk : counts) place += std::exchange(chunk.of[d], place);
        rt::parallel_for(host, chunk_count,
                         [&](rt_u32 c) { each(c, [&](MortonKey key) { to[counts[c].of[digit(key)]++] = key; }); });
        std::swap(from, to);
    }
    static_assert((64 - kPositionBits) / kDigitBits % 2 == 0, "after an even number of passes the keys are where they were");
}

void gather(const Workspace& workspace, const MortonKey* keys, uint32_t begin, uint32_t end) {
    for (uint32_t i = begin; i < end; ++i)
        workspace.records[1][i] = workspace.records[0][keys[i] & ((MortonKey{1} << kPositionBits) - 1)];
}

uint32_t morton_middle(const MortonKey* keys, uint32_t begin, uint32_t end) {
    const uint64_t first = keys[begin] >> kPositionBits, last = keys[end - 1] >> kPositionBits;
    if (first == last) return begin + (end - begin) / 2;  // all in one cell
    uint64_t highest = first ^ last;
    for (unsigned shift = 1; shift < 64; shift *= 2) highest |= highest >> shift;
    const uint64_t least_right = last & ~(highest >> 1);  // with the highest bit that differs, and none below it
    uint32_t low = begin + 1, high = end - 1;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (keys[middle] >> kPositionBits < least_right)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

Subtree build_sorted(const Workspace& workspace, const MortonKey* keys, Range& range) {
    Builder builder(workspace, keys, range.begin);
    Subtree result;
    result.root = builder.build(range.begin, range.end, range.depth, range.box);
    result.nodes = builder.next_node() - range.begin;
    result.depth = builder.depth();
    return result;
}

}  // namespace bvh2
