// morton.hpp -- sorts primitives along a space-filling curve for the fast builder (Lauterbach, Garland, Sengupta, Luebke,
// Manocha 2009, "Fast BVH Construction on GPUs"). A node splits its primitives where the highest bit of their positions on the
// curve changes.
//
// The highest digits of the positions split each group into runs, on all cores. A run is small enough for one thread, which
// sorts it and builds its tree while the core's own cache holds it.
#pragma once
#include <vector>

#include "clarity_bvh/base/scratch.hpp"
#include "clarity_bvh/build/curve.hpp"

namespace clarity::bvh {

// The position on the curve, above the number of the primitive in its group (28 bits). Sorting by keys sorts by both.
using MortonKey = uint64_t;
constexpr unsigned kPositionBits = 28;
inline uint32_t position(MortonKey key) {
    return static_cast<uint32_t>(key & ((MortonKey{1} << kPositionBits) - 1));
}

class MortonOrder {
 public:
    // Codes of children: the index of a top node, or with this bit the index of a run.
    static constexpr rt_u32 kRun = 0x80000000u;
    // The primitives of one stretch of the curve, [begin, end) in leaf order.
    struct Run {
        rt_u32 group;
        uint32_t begin, end;
        uint32_t depth;     // number of nodes above it
        unsigned unsorted;  // the keys are not yet sorted by this many low bits of their positions
        int buffer;         // which key buffer holds its keys, 0 or 1
        uint32_t count() const { return end - begin; }
    };
    // An inner node above the runs.
    struct Top {
        rt_u32 group, child[2];
        uint32_t middle;  // position in leaf order where its right child begins
    };
    struct Group {
        Bounds box;
        rt_u32 code = RT_NONE;  // RT_NONE if the group is empty
        uint32_t begin = 0;     // first position in leaf order
    };

    // Returns the memory for the keys, in bytes.
    static uint64_t bytes(uint64_t primitive_count) { return 2 * primitive_count * sizeof(MortonKey); }

    // Finds the runs of all groups, on all cores. `input` must outlive this object.
    MortonOrder(const rt_host* host, const rt_build_input& input, uint64_t primitive_count);

    const std::vector<Group>& groups() const { return groups_; }
    const std::vector<Top>& tops() const { return tops_; }  // parents before children
    const std::vector<Run>& runs() const { return runs_; }  // in leaf order
    const rt_prim* prims(rt_u32 group) const { return input_.prims + input_.groups[group].first; }

    // Sorts the keys of a run (stable for equal positions) and returns them. Different runs may be sorted by different threads.
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

}  // namespace clarity::bvh
