// kernels.hpp -- the inner loops of the builders, compiled for several instruction sets. All of them give the same bits.
#pragma once
#include "clarity_bvh/kernels/range.hpp"
#include "clarity_bvh/topology.hpp"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(CLARITY_BVH_PORTABLE) && !defined(CLARITY_BVH_NO_AVX2)
#define CLARITY_BVH_AVX2 1
#endif

namespace clarity::bvh {

// The arrays of a build. All threads share one workspace; each touches only its own ranges.
struct Workspace {
    Rules rules;
    Record* records[2];
    // As long as the records. n primitives make at most n - 1 nodes. So the nodes of a task fit into its range of this
    // array and leave the last place free. The node that joins two ranges takes that place in the first of them.
    Node* nodes;
    rt_u32* leaves;  // refs in leaf order; with spatial splits it is as long as the records and has gaps between tasks
};

// The tree of one task.
struct Subtree {
    uint32_t root = 0;   // child code: a leaf, or the index of the root node
    uint32_t nodes = 0;  // number of nodes, from workspace.nodes[range.begin] on, parents before children
    uint32_t depth = 0;  // number of nodes on the path from the group's root to the deepest leaf
};

// The cheapest way to divide i + 1 subtree roots between a left and a right child, for i = 0..7. Among ways of equal cost, the
// one with the fewest roots on the left wins. share_roots() finds it from these costs: left[l - 1] for l roots of the left
// child, right[7 + r] for r roots of the right child; right[0..7] are infinite.
constexpr uint32_t kRoots = 8;
struct alignas(16) SharedRoots {
    float cost[kRoots];
    float left[kRoots];  // number of roots that come from the left child
};

// How well one child suits each of the places 0..7 of a node; larger is better.
constexpr uint32_t kPlaces = 8;
struct alignas(32) Suits {
    float place[kPlaces];
};

struct Kernels {
    void (*clear)(Bins& bins, uint32_t bin_count);
    void (*bin)(const Record* first, const Record* end, const Slices& slices, Bins& bins);
    void (*merge)(const Bins& from, uint32_t bin_count, Bins& to);
    // `split` must be default-initialised. It is an output argument, not a return value: see load_box() in box8.inl.
    void (*find_split)(const Bins& bins, uint32_t bin_count, const AreaScale& area, uint32_t primitive_count, Split& split);
    // Copies the records [first, end) to `left` and `right` in their old order, and computes the centroid bounds of both sides.
    void (*scatter)(const Record* first, const Record* end, const Slices& slices, const Split& split, Record* left,
                    Record* right, Bounds& left_centroids2, Bounds& right_centroids2);
    // Builds the tree of one range on one thread, without allocating. Nodes are written from first_node on, leaves from
    // first_leaf on.
    Subtree (*build_subtree)(const Workspace& workspace, const Range& range, uint32_t first_node, uint32_t first_leaf);
    // Finds the cheapest divisions: see SharedRoots.
    void (*share_roots)(const float left[kRoots], const float right[2 * kRoots], SharedRoots& shared);
    // Assigns children to places greedily: the best pair of all remaining ones is assigned first. The lowest bits of
    // suits[i].place[p] must hold the tag kPlaces * i + p, so that no two values are equal. `suits` is overwritten.
    void (*assign_places)(Suits suits[], uint32_t count, uint32_t place_of[]);
};

namespace generic {
extern const Kernels kernels;
}
namespace avx2 {
extern const Kernels kernels;
}
// The fastest kernels that this machine can run.
const Kernels& kernels();

void bound(const Record* first, const Record* end, Bounds& box, Bounds& centroids2);
// Splits a range into halves by count along the longest axis of its centroids, in place. Used where the heuristic finds no
// split.
void halve(Record* records, const Range& range, Range& left, Range& right);

}  // namespace clarity::bvh
