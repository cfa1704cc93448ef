// morton_order.hpp -- the order of primitives along a Morton curve that the step `curve` of rt_device.h gives on a
// device; and the same order on the host, for builders that build the same tree on both.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "rt_plugin.h"

namespace clarity::bvh {

// Bits of a code for each axis. A sort takes a pass for 8 bits: 24 bits need three, 39 bits five. Trees over finer codes cost
// no less.
constexpr uint64_t kMostWithShortCodes = uint64_t{1} << 17;
constexpr uint32_t axis_bits(uint64_t count) {
    return count <= kMostWithShortCodes ? 8 : 13;
}
constexpr uint32_t code_bits(uint64_t count) {
    return 3 * axis_bits(count);
}

// The bits of n: floor(log2(n)) + 1.
constexpr uint32_t bit_count(uint64_t n) {
    uint32_t bits = 0;
    for (; n > 0; n /= 2) ++bits;
    return bits;
}
// A radix tree over the codes has so many inner nodes on the way from its root to a leaf, at most: each splits by a bit of its
// own, of the code or of the place.
constexpr uint32_t depth_bound(uint64_t count) {
    return code_bits(count) + bit_count(count);
}

struct CurveKey {
    uint64_t code;
    uint32_t number;  // of the primitive in its group
    bool operator<(const CurveKey& other) const { return code != other.code ? code < other.code : number < other.number; }
};
// The primitives of a group along the curve. On all cores, but for the sort.
std::vector<CurveKey> order_along_curve(const rt_host* host, const rt_prim* prims, uint32_t count);

// A group of two primitives or more whose tree is to be built. Its 2n - 1 nodes begin at nodes[base]: first the inner ones,
// then the leaves in the order of the curve, which are written.
struct CurveGroup {
    const rt_prim* prims;
    const std::vector<CurveKey>& keys;
    rt_topology_node* nodes;
    rt_u32 base, leaves;  // leaves: index of the first leaf
};
// rt_accel::topology of a builder whose trees stand over this order. write_inner: writes the inner nodes of a group, whose
// children are indices of `nodes`, and returns the root. id: of the plugin, for messages.
int32_t build_along_curve(const rt_host* host, const rt_build_input* input, const rt_topology_output* out, const char* id,
                          const std::function<rt_u32(const CurveGroup&)>& write_inner);

}  // namespace clarity::bvh
