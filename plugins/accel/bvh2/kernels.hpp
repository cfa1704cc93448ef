// kernels.hpp -- the inner loops of building, compiled for more than one instruction set; all give the same bits.
#pragma once
#include "range.hpp"
#include "rt_plugin.h"
// after rt_types.h, whose types it uses:
#include "bvh2_types.h"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(BVH2_PORTABLE) && !defined(BVH2_NO_AVX2)
#define BVH2_AVX2 1
#endif

namespace bvh2 {

// Where a build keeps its things; one for all threads, each of which touches its own ranges only.
struct Workspace {
    Rules rules;
    Record* records[2];
    // As many as records. Of n primitives come n - 1 nodes at most, so those of a task fit where its range lies, and the node
    // that parts two ranges, in front of the second one.
    bvh2_node* nodes;
    rt_u32* leaves;  // refs in leaf order; with spatial splits as many as records, and gaps between tasks
};

// The tree of one task.
struct Subtree {
    uint32_t root = 0;   // code of a child: a leaf, or the first node of the range
    uint32_t nodes = 0;  // from workspace.nodes[range.begin] on, parents before children
    uint32_t depth = 0;  // nodes from the root of the group to the deepest leaf
};

// The cheapest ways to share i + 1 roots of subtrees between a left and a right child, i = 0..7: left[l - 1] is the cost of l
// roots from the left child, right[7 + r] that of r from the right one, right[0..7] infinite. Among equals the fewest go to the
// left.
constexpr uint32_t kRoots = 8;
struct alignas(16) SharedRoots {
    float cost[kRoots];
    float left[kRoots];  // how many go there
};

// Numbers of eight things that are to go to eight places, in pairs: how well each suits place 0..7.
constexpr uint32_t kPlaces = 8;
struct alignas(32) Suits {
    float place[kPlaces];
};

struct Kernels {
    void (*clear)(Bins& bins, uint32_t bin_count);
    void (*bin)(const Record* first, const Record* end, const Slices& slices, Bins& bins);
    void (*merge)(const Bins& from, uint32_t bin_count, Bins& to);
    // `split` is as it was made. Not returned: see box8.inl.
    void (*find_split)(const Bins& bins, uint32_t bin_count, const AreaScale& area, uint32_t primitive_count, Split& split);
    // Copies [first, end) to where left and right point, keeping the order, and bounds the centroids of both sides.
    void (*scatter)(const Record* first, const Record* end, const Slices& slices, const Split& split, Record* left,
                    Record* right, Bounds& left_centroids2, Bounds& right_centroids2);
    // Builds the tree of one range on one thread, without allocating; nodes and leaves are put from the given places on.
    Subtree (*build_subtree)(const Workspace& workspace, const Range& range, uint32_t first_node, uint32_t first_leaf);
    void (*share_roots)(const float left[kRoots], const float right[2 * kRoots], SharedRoots& shared);
    // Gives things to places: of all pairs left over the best one goes together. suits[i] carry the tag kPlaces i + place, so
    // no two are equal; they are lost.
    void (*assign_places)(Suits suits[], uint32_t count, uint32_t place_of[]);
};

namespace generic {
extern const Kernels kernels;
}
namespace avx2 {
extern const Kernels kernels;
}
// Those of this machine.
const Kernels& kernels();

void bound(const Record* first, const Record* end, Bounds& box, Bounds& centroids2);
// Halves by count along the longest axis of the centroids, in place. For what the heuristic cannot split.
void halve(Record* records, const Range& range, Range& left, Range& right);

void set_child(bvh2_node& node, int which, const Bounds& box, uint32_t child);

}  // namespace bvh2
