// kernel_table.hpp -- the table of all kernels that trace rays. A new kernel is a new row here and a file in cl/.
#pragma once
#include <string>
#include <vector>

#include "render/kernels/layout.hpp"
#include "render/settings/settings.hpp"
#include "rt_plugin.h"

namespace clarity {

// What a kernel computes.
enum class KernelKind {
    color,          // the colours of a frame
    generations,    // a frame as for `color`, but the picture shows the number of ray generations of each pixel
    aov,            // one property of the nearest hit of each pixel
    rays,           // ray queries, one block of lanes after the other
    counted_rays,   // the same with counters of steps and leaf tests
    requeued_rays,  // ray queries of one lane in two launches: long rays are traced again by many work-items
    dynamic_fetch,  // ray queries of one lane: a work-item that is done fetches another ray. Nearest hits only
    warp_rays,      // ray queries of one lane: all rays of a warp visit the same nodes
    warp_pairs,     // the same with two rays a work-item
    inspect         // a record of each ray of one pixel
};

// How much of a frame a kernel of kind `color` computes; see frame_parts.hpp. The first three end early: after writing the
// film, after camera rays, after their nearest hits. double_leaf: leaf tests are done twice, which does not change the picture.
enum class FramePart { film, rays, closest, closest_double_leaf, whole, whole_closest_double_leaf, whole_any_double_leaf };

constexpr unsigned kRequeueItems = 32;  // work-items that trace one long ray together: a warp

// The inputs that choose a row and fill in its defines.
struct KernelChoice {
    KernelKind kind;
    FramePart part;
    const Settings& settings;
    const Layout& layout;
};

// Properties of a kernel, as bits of KernelRow::traits.
enum : unsigned {
    kNearestOnly = 1,     // has no any-hit traversals
    kReadsUvs = 2,        // reads texture coordinates even if the scene has no texture
    kRaySlots = 4,        // keeps a packet's rays in private memory, settings.ray_slots for each pixel
    kLimitRegisters = 8,  // is faster on GPUs with fewer registers than it would take: program_cache.cpp has the numbers
    kFrameQueues = 16,    // has the rays of the whole frame in queues: several kernels, which wavefront.hpp launches
    kVotes = 32           // uses votes among the work-items of a warp: cl/lanes/subgroup.h
};

struct KernelRow {
    KernelKind kind;
    bool (*applies)(const KernelChoice&);  // null: always. The first row of a kind that applies is used
    const char* what;                      // for messages: "ray queries"
    const char* file;                      // below cl/, included last
    const char* entry;                     // name of the kernel function
    std::vector<const char*> headers;      // below cl/, included after the traversals and before `file`
    std::vector<std::string> defines;      // "NAME" or "NAME VALUE", ahead of all includes
    unsigned traits;
    rt_u32 needs;            // capabilities that the structure must have: RT_TRAVERSES_STEPS...
    unsigned rays_per_item;  // for kernels that trace a warp's rays together; else 0
    bool has(unsigned trait) const { return (traits & trait) != 0; }
};

const std::vector<KernelRow>& kernel_table();
// Returns the first row that applies. Throws std::logic_error if there is none.
const KernelRow& kernel_row(const KernelChoice& choice);

}  // namespace clarity
