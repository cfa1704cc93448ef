// leaf_packer.hpp -- packs the primitives of a structure again where they have moved to, while the plugin refits its tree.
//
// The plugin asks for the boxes of some hundred primitives at a time (rt_refit_input::prims). They are packed into the host's
// leaves in the same step, so that each is read and written once: 12 B of vertex numbers, three vertices, and 48 B each way.
#pragma once
#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "rt_refit.h"
#include "structures/accel_build.hpp"
#include "structures/rows.hpp"

namespace clarity {

// Which vertices the triangles in leaf order have. For other primitives the entries are unused.
UninitializedVector<rt_u32> corners_in_leaf_order(const Scene& scene, const AccelData& accel);

// The groups of refs.
class GroupOfRef {
 public:
    explicit GroupOfRef(const BuildScene& scene);
    // The group of a ref; of triangles also the range of refs [first, first + count) that are in it.
    rt_u32 find(rt_u32 ref, rt_u32& first, rt_u32& count) const;

 private:
    struct Range {
        rt_u32 first, group;
    };
    std::vector<Range> ranges_;  // of triangles, ascending
    rt_u32 triangle_count_ = 0;
};

// Serves one call of a plugin. Thread-safe.
class LeafPacker {
 public:
    // leaves: those of `accel`, which are written. positions: of all vertices, 3 numbers each, in the space of their groups,
    // and one more float at the end. boxes: receives those of the groups.
    LeafPacker(AccelData& accel, const UninitializedVector<rt_u32>& corners, const float* positions, const GroupOfRef& groups,
               std::vector<Bounds>& boxes);
    // rt_refit_input::prims; ctx: this object.
    static int32_t prims(void* ctx, uint64_t first, uint64_t count, rt_prim* prims);
    uint64_t asked() const { return asked_; }  // positions

 private:
    void pack(uint64_t first, uint64_t count, rt_prim* prims);
    void pack_other(rt_packed_prim& leaf, Row& lo, Row& hi, Row& name) const;
    void add(rt_u32 group, Row lo, Row hi);

    AccelData& accel_;
    const rt_u32* const corners_;
    const float* const positions_;
    const GroupOfRef& groups_;
    std::vector<Bounds>& boxes_;
    std::mutex mutex_;
    std::atomic<uint64_t> asked_{0};
};

}  // namespace clarity
