#include "clarity_bvh/build/morton.hpp"

#include <array>
#include <utility>

#include "rt_plugin.hpp"

namespace clarity::bvh {
namespace {

constexpr unsigned kDigitBits = 9, kDigits = 1u << kDigitBits;  // digit of one parallel sorting pass
using Counts = std::array<uint32_t, kDigits>;

// The keys, boxes and nodes of a run fit into a core's own cache. Small scenes get smaller runs, so that no core runs out of
// work before the end.
uint32_t run_size_for(uint64_t primitive_count) {
    return static_cast<uint32_t>(std::clamp<uint64_t>(primitive_count / 16, 1024, 8192));
}
uint32_t chunk_size_for(uint32_t count) {
    return std::clamp(count / 8, 512u, 1u << 15);
}

void insertion_sort(MortonKey* keys, uint32_t count) {
    for (uint32_t i = 1; i < count; ++i) {
        const MortonKey key = keys[i];
        uint32_t at = i;
        for (; at > 0 && keys[at - 1] > key; --at) keys[at] = keys[at - 1];
        keys[at] = key;
    }
}

}  // namespace

// Splits one group into runs and top nodes.
struct MortonOrder::Builder {
    const MortonOrder& order;
    const rt_u32 group;
    const uint32_t group_begin, count;
    const rt_prim* const prims;
    std::vector<Top> tops;  // child codes count within this group
    std::vector<Run> runs;

    MortonKey* keys(int buffer) const { return order.keys_[buffer].data(); }

    template <class Body>  // do_chunk(index, begin, end)
    void each_chunk(uint32_t begin, uint32_t end, Body&& do_chunk) const {
        const uint32_t size = chunk_size_for(end - begin);
        rt::parallel_for(order.host_, (end - begin + size - 1) / size, [&](rt_u32 c) {
            const uint32_t at = begin + c * size;
            do_chunk(c, at, std::min(at + size, end));
        });
    }
    static uint32_t chunk_count(uint32_t n) { return (n + chunk_size_for(n) - 1) / chunk_size_for(n); }
    static unsigned digit_bits(unsigned unsorted) { return std::min(kDigitBits, unsorted); }
    static uint32_t digit(MortonKey key, unsigned unsorted) {
        const unsigned bits = digit_bits(unsorted);
        return static_cast<uint32_t>(key >> (kPositionBits + unsorted - bits)) & ((1u << bits) - 1);
    }

    Group run() {
        Group result;
        result.begin = group_begin;
        if (count == 0) return result;
        struct Part {
            Bounds box, half_centroids;
        };
        std::vector<Part> parts(chunk_count(count));
        each_chunk(0, count, [&](rt_u32 c, uint32_t begin, uint32_t end) {
            Vec4 lo = splat(FLT_MAX), neg_hi = lo, least = lo, neg_most = lo;
            for (uint32_t i = begin; i < end; ++i) {
                fetch(prims + i + kStreamAhead);
                Vec4 prim_lo, prim_neg_hi;
                sound_box(prims[i], prim_lo, prim_neg_hi);
                const Vec4 centroid = half_centroid(prim_lo, prim_neg_hi);
                lo = min(lo, prim_lo);
                neg_hi = min(neg_hi, prim_neg_hi);
                least = min(least, centroid);
                neg_most = min(neg_most, splat(0.0f) - centroid);
            }
            store(parts[c].box.lo, lo);
            store(parts[c].box.neg_hi, neg_hi);
            store(parts[c].half_centroids.lo, least);
            store(parts[c].half_centroids.neg_hi, neg_most);
        });
        for (size_t c = 1; c < parts.size(); ++c) {
            parts[0].box.add(parts[c].box);
            parts[0].half_centroids.add(parts[c].half_centroids);
        }
        result.box = parts[0].box;
        const Curve curve(parts[0].half_centroids, count);
        std::vector<Counts> counts(parts.size());
        each_chunk(0, count, [&](rt_u32 c, uint32_t begin, uint32_t end) {
            counts[c].fill(0);
            MortonKey* const to = keys(0) + group_begin;
            for (uint32_t i = begin; i < end; ++i) {
                fetch(prims + i + kStreamAhead);
                Vec4 lo, neg_hi;
                sound_box(prims[i], lo, neg_hi);
                to[i] = curve.place(half_centroid(lo, neg_hi)) << kPositionBits | i;
                ++counts[c][digit(to[i], curve.bits())];
            }
        });
        result.code = part(group_begin, group_begin + count, curve.bits(), 0, 0, std::move(counts));
        return result;
    }

    rt_u32 add_run(uint32_t begin, uint32_t end, unsigned unsorted, int buffer, uint32_t depth) {
        runs.push_back({group, begin, end, depth, unsorted, buffer});
        return static_cast<rt_u32>(runs.size() - 1) | kRun;
    }

    // Adds a top node. do_left and do_right build its children and return their codes.
    template <class Left, class Right>
    rt_u32 add_top(uint32_t middle, Left&& do_left, Right&& do_right) {
        const size_t top = tops.size();
        tops.push_back({group, {}, middle});
        const rt_u32 left = do_left(), right = do_right();
        tops[top].child[0] = left;
        tops[top].child[1] = right;
        return static_cast<rt_u32>(top);
    }

    // Splits a range of positions that differ in their lowest `unsorted` bits only. `counts` are the counts of its next digit
    // per chunk, or empty if they are not known yet.
    rt_u32 part(uint32_t begin, uint32_t end, unsigned unsorted, int buffer, uint32_t depth, std::vector<Counts> counts = {}) {
        if (end - begin <= order.run_size_) return add_run(begin, end, unsorted, buffer, depth);
        if (unsorted == 0) return part_cell(begin, end, buffer, depth);
        MortonKey *const from = keys(buffer), *const to = keys(buffer ^ 1);
        if (counts.empty()) {
            counts.resize(chunk_count(end - begin));
            each_chunk(begin, end, [&](rt_u32 c, uint32_t first, uint32_t last) {
                counts[c].fill(0);
                for (uint32_t i = first; i < last; ++i) ++counts[c][digit(from[i], unsorted)];
            });
        }
        const uint32_t digits = 1u << digit_bits(unsorted);
        std::vector<uint32_t> begins(digits + 1, end);
        uint32_t place = begin;
        for (uint32_t d = 0; d < digits; ++d) {
            begins[d] = place;
            for (Counts& chunk : counts) place += std::exchange(chunk[d], place);
        }
        each_chunk(begin, end, [&](rt_u32 c, uint32_t first, uint32_t last) {
            Counts& places = counts[c];
            for (uint32_t i = first; i < last; ++i) to[places[digit(from[i], unsorted)]++] = from[i];
        });
        return part_digits(begins, 0, digits, unsorted - digit_bits(unsorted), buffer ^ 1, depth);
    }

    // Splits the primitives with digits first..last-1, where last - first is a power of two. `unsorted` is the number of
    // bits below the digit.
    rt_u32 part_digits(const std::vector<uint32_t>& begins, uint32_t first, uint32_t last, unsigned unsorted, int buffer,
                       uint32_t depth) {
        const uint32_t begin = begins[first], end = begins[last], half = (last - first) / 2;
        if (end - begin <= order.run_size_) return add_run(begin, end, unsorted + log2_ceil(last - first), buffer, depth);
        if (half == 0) return part(begin, end, unsorted, buffer, depth);
        const uint32_t middle = begins[first + half];
        const auto left = [&](uint32_t below) { return part_digits(begins, first, first + half, unsorted, buffer, below); };
        const auto right = [&](uint32_t below) { return part_digits(begins, first + half, last, unsorted, buffer, below); };
        if (middle == end) return left(depth);
        if (middle == begin) return right(depth);
        return add_top(middle, [&] { return left(depth + 1); }, [&] { return right(depth + 1); });
    }

    // Splits primitives that all lie in one cell of the curve. Normally it lays a finer curve through the cell. It halves them
    // by count if another curve (its bits, then the halves below) could make leaves too deep.
    rt_u32 part_cell(uint32_t begin, uint32_t end, int buffer, uint32_t depth) {
        if (depth + Curve::kMaxBits + log2_ceil(end - begin) < kMaxDepth) {
            Bounds half_centroids;
            const auto centroid = [&](uint32_t i) {
                Vec4 lo, neg_hi;
                sound_box(prims[position(keys(buffer)[i])], lo, neg_hi);
                return half_centroid(lo, neg_hi);
            };
            for (uint32_t i = begin; i < end; ++i) {
                store(half_centroids.lo, min(load(half_centroids.lo), centroid(i)));
                store(half_centroids.neg_hi, min(load(half_centroids.neg_hi), splat(0.0f) - centroid(i)));
            }
            const Curve curve(half_centroids, end - begin);
            const Vec4 most = splat(0.0f) - load(half_centroids.neg_hi);
            if (curve.place(xyz(load(half_centroids.lo))) != curve.place(xyz(most))) {  // else all centroids are (nearly) equal
                each_chunk(begin, end, [&](rt_u32, uint32_t first, uint32_t last) {
                    for (uint32_t i = first; i < last; ++i)
                        keys(buffer)[i] = curve.place(centroid(i)) << kPositionBits | position(keys(buffer)[i]);
                });
                return part(begin, end, curve.bits(), buffer, depth);
            }
        }
        if (end - begin <= order.run_size_) return add_run(begin, end, 0, buffer, depth);
        const uint32_t middle = begin + (end - begin) / 2;
        return add_top(
            middle, [&] { return part_cell(begin, middle, buffer, depth + 1); },
            [&] { return part_cell(middle, end, buffer, depth + 1); });
    }
};

MortonOrder::MortonOrder(const rt_host* host, const rt_build_input& input, uint64_t primitive_count)
    : host_(host),
      input_(input),
      run_size_(run_size_for(primitive_count)),
      keys_{Scratch<MortonKey>(primitive_count), Scratch<MortonKey>(primitive_count)},
      groups_(input.group_count) {
    std::vector<Builder> builders;
    builders.reserve(input.group_count);
    uint32_t before = 0;
    for (rt_u32 g = 0; g < input.group_count; ++g) {
        builders.push_back({*this, g, before, input.groups[g].count, prims(g), {}, {}});
        before += input.groups[g].count;
    }
    rt::parallel_for(host, input.group_count, [&](rt_u32 g) { groups_[g] = builders[g].run(); });
    for (rt_u32 g = 0; g < input.group_count; ++g) {
        const auto first_top = static_cast<rt_u32>(tops_.size()), first_run = static_cast<rt_u32>(runs_.size());
        const auto shifted = [&](rt_u32 code) { return code + (code & kRun ? first_run : first_top); };
        if (groups_[g].code != RT_NONE) groups_[g].code = shifted(groups_[g].code);
        for (Top top : builders[g].tops) {
            for (rt_u32& child : top.child) child = shifted(child);
            tops_.push_back(top);
        }
        runs_.insert(runs_.end(), builders[g].runs.begin(), builders[g].runs.end());
    }
}

// A radix sort, least significant digit first. The digits are wider the more keys there are, because each digit costs counting.
const MortonKey* MortonOrder::sort(const Run& run) const {
    constexpr unsigned kMostBits = 10, kMostPasses = (Curve::kMaxBits + 6) / 7;
    constexpr uint32_t kFew = 32;
    const uint32_t count = run.count();
    MortonKey *from = keys_[run.buffer].data() + run.begin, *to = keys_[run.buffer ^ 1].data() + run.begin;
    if (run.unsorted == 0) return from;
    if (count <= kFew) {
        insertion_sort(from, count);
        return from;
    }
    const unsigned most = std::clamp(log2_ceil(count) - 1, 7u, kMostBits);
    const unsigned passes = (run.unsorted + most - 1) / most, bits = (run.unsorted + passes - 1) / passes;
    const uint32_t mask = (1u << bits) - 1;
    uint32_t counts[kMostPasses][1u << kMostBits];
    for (unsigned p = 0; p < passes; ++p) std::fill_n(counts[p], mask + 1, 0u);
    for (uint32_t i = 0; i < count; ++i) {
        MortonKey place = from[i] >> kPositionBits;
        for (unsigned p = 0; p < passes; ++p, place >>= bits) ++counts[p][place & mask];
    }
    for (unsigned p = 0; p < passes; ++p) {
        const unsigned shift = kPositionBits + p * bits;
        const auto digit = [&](MortonKey key) { return static_cast<uint32_t>(key >> shift) & mask; };
        if (counts[p][digit(from[0])] == count) continue;  // all keys have the same digit
        uint32_t place = 0;
        for (uint32_t d = 0; d <= mask; ++d) place += std::exchange(counts[p][d], place);
        for (uint32_t i = 0; i < count; ++i) to[counts[p][digit(from[i])]++] = from[i];
        std::swap(from, to);
    }
    return from;
}

}  // namespace clarity::bvh
