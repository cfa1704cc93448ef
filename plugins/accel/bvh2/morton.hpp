// morton.hpp -- primitives along a space-filling curve, for the fast builder: nodes are parted where the highest bit of their
// places on it changes (Lauterbach, Garland, Sengupta, Luebke, Manocha 2009, "Fast BVH Construction on GPUs").
//
// The highest digits of the places part each group on all cores, until ranges are one thread's work: runs. A run is sorted, and
// its tree made, while a core's own cache holds it.
#pragma once
#include <vector>

#include "curve.hpp"
#include "scratch.hpp"

namespace bvh2 {

// A primitive's place on the curve above its number in its group (28 bits): sorting keys sorts both.
using MortonKey = uint64_t;
constexpr unsigned kPositionBits = 28;
inline uint32_t position(MortonKey key) {
    return static_cast<uint32_t>(key & ((MortonKey{1} << kPositionBits) - 1));
}

class MortonOrder {
 public:
    // Codes of what is below a group or a top node: the index of one, or with this bit of a run.
    static constexpr rt_u32 kRun = 0x80000000u;
    // A part of a group: all that lies on one stretch of the curve, [begin, end) in leaf order.
    struct Run {
        rt_u32 group;
        uint32_t begin, end;
        uint32_t depth;     // nodes above it
        unsigned unsorted;  // low bits of the places by which keys are yet to be sorted
        int buffer;         // that holds the keys
        uint32_t count() const { return end - begin; }
    };
    // A node above the runs.
    struct Top {
        rt_u32 group, child[2];
        uint32_t middle;  // first position of the right part
    };
    struct Group {
        Bounds box;
        rt_u32 code = RT_NONE;  // RT_NONE: it is empty
        uint32_t begin = 0;     // in leaf order
    };

    static uint64_t bytes(uint64_t primitive_count) { return 2 * primitive_count * sizeof(MortonKey); }

    // The input must live as long as this.
    MortonOrder(const rt_host* host, const rt_build_input& input, uint64_t primitive_count);

    const std::vector<Group>& groups() const { return groups_; }
    const std::vector<Top>& tops() const { return tops_; }  // parents before children
    const std::vector<Run>& runs() const { return runs_; }  // in leaf order
    const rt_prim* prims(rt_u32 group) const { return input_.prims + input_.groups[group].first; }

    // Sorts the keys of a run, equal places as they came, and returns them. By any thread.
    const MortonKey* sort(const Run& run) const;

 private:
    struct Builder;

    const rt_host* const host_;
    const rt_build_input& input_;
    const uint32_t run_size_;
    Scratch<MortonKey> keys_[2];
    std::vector<Group> groups_;
    std::vector<Top> tops_;
    std::vector<Run> runs_;
};

}  // namespace bvh2
