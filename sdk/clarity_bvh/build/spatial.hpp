// spatial.hpp -- spatial splits (Stich, Friedrich, Dietrich 2009, "Spatial Splits in Bounding Volume Hierarchies"). A triangle
// that crosses the plane goes to both sides, each with the bounds of its part. This is done where overlapping boxes would cost
// more than testing the triangle twice. The number of added references is limited from the start: each range has room for some,
// and its two parts share what is left by their sizes. So the result does not depend on which thread comes first.
#pragma once
#include "clarity_bvh/kernels/kernels.hpp"

namespace clarity::bvh {

// A range with its room: the positions that it and its parts may take in both buffers, and in the arrays of nodes and leaves.
struct RoomyRange {
    Range range;
    uint32_t room_begin = 0, room_end = 0;
    uint32_t spare() const { return room_end - room_begin - range.count(); }
};

class SpatialSplitter {
 public:
    // `root` is the box of the group. Overlaps are measured relative to it.
    SpatialSplitter(const rt_host* host, const Workspace& workspace, const rt_geometry& geometry, const Bounds& root);

    // Splits a range into two parts and moves its primitives. Large ranges use all cores. The range must hold more than a few
    // primitives.
    void split(const RoomyRange& from, RoomyRange& left, RoomyRange& right) const;

    // Builds the whole tree of a range on one thread. Its nodes begin at workspace.nodes[range.room_begin], its refs at
    // workspace.leaves[range.room_begin]. leaf_count returns the number of refs.
    Subtree build(const RoomyRange& range, uint32_t& leaf_count) const;

 private:
    struct Growth;
    void find_object_split(const Range& range, const AreaScale& area, Split& split) const;
    // Splits a range by a plane in space. Returns false if that is no better than `object`, or if there is no room for the
    // added references.
    bool cut(const RoomyRange& from, const AreaScale& area, const Split& object, RoomyRange& left, RoomyRange& right) const;
    uint32_t build_range(const RoomyRange& range, Growth& growth) const;

    const rt_host* const host_;
    const Workspace& workspace_;
    const rt_geometry& geometry_;
    const AreaScale root_scale_;
    const float root_area_;
};

}  // namespace clarity::bvh
