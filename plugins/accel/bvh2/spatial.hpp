// spatial.hpp -- splits of space besides splits of the primitives (Stich, Friedrich, Dietrich 2009, "Spatial Splits in Bounding
// Volume Hierarchies"): a triangle that a plane cuts goes to both sides, with the bounds of its parts, where boxes that overlap
// cost more than it does to meet it twice. How many references this may add is bounded from the start: a range has room, which
// its two parts share by their sizes, so nothing depends on which thread comes first.
#pragma once
#include "kernels.hpp"

namespace bvh2 {

// A range and the places that it and its parts may take in either buffer, and their nodes and leaves elsewhere.
struct RoomyRange {
    Range range;
    uint32_t room_begin = 0, room_end = 0;
    uint32_t spare() const { return room_end - room_begin - range.count(); }
};

class SpatialSplitter {
 public:
    // root: the box of the group, against which overlaps are measured.
    SpatialSplitter(const rt_host* host, const Workspace& workspace, const rt_geometry& geometry, const Bounds& root);

    // Splits a range of more than a few, moving its primitives; large ones on all cores.
    void split(const RoomyRange& from, RoomyRange& left, RoomyRange& right) const;

    // The whole tree of a range, on one thread; its nodes, and its refs in workspace.leaves, begin at range.room_begin.
    // leaf_count: refs.
    Subtree build(const RoomyRange& range, uint32_t& leaf_count) const;

 private:
    struct Growth;
    void find_object_split(const Range& range, const AreaScale& area, Split& split) const;
    // Cuts a range by a plane in space; false: that is no better than `object`, or there is no room for it.
    bool cut(const RoomyRange& from, const AreaScale& area, const Split& object, RoomyRange& left, RoomyRange& right) const;
    uint32_t build_range(const RoomyRange& range, Growth& growth) const;

    const rt_host* const host_;
    const Workspace& workspace_;
    const rt_geometry& geometry_;
    const AreaScale root_scale_;
    const float root_area_;
};

}  // namespace bvh2
