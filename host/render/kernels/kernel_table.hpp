// kernel_table.hpp -- every kernel that traces, one row each. A new kernel is a new row here and a file in cl/.
#pragma once
#include <string>
#include <vector>

#include "render/kernels/layout.hpp"
#include "render/settings/settings.hpp"
#include "rt_plugin.h"

namespace clarity {

// What a kernel answers.
enum class KernelKind {
    color,          // a frame's colours
    generations,    // a frame of colours whose picture is the number of ray generations of each pixel
    aov,            // one property of the nearest hit of each pixel
    rays,           // ray queries, one block of lanes after the other
    counted_rays,   // the same with counters of steps and leaf tests
    requeued_rays,  // ray queries of one lane in two launches: long rays are traced again by many work-items
    dynamic_fetch,  // ray queries of one lane: a work-item that is done fetches another ray. Nearest hits only
    warp_rays,      // ray queries of one lane: all rays of a warp take one way through the tree
    warp_pairs,     // the same with two rays a work-item
    inspect         // the rays of one pixel, written down
};

// How much of a frame a kernel of kind `color` does; see frame_parts.hpp. The first three are its beginning: the film alone,
// camera rays, their nearest hits. double_leaf: leaf tests are done twice, which does not change the picture.
enum class FramePart { film, rays, closest, closest_double_leaf, whole, whole_closest_double_leaf, whole_any_double_leaf };

constexpr unsigned kRequeueItems = 32;  // work-items that trace one long ray together: as many as a warp has

// What chooses a row and fills in its defines.
struct KernelChoice {
    KernelKind kind;
    FramePart part;
    const Settings& settings;
    const Layout& layout;
};

// What else a kernel is, as bits of KernelRow::traits.
enum : unsigned {
    kNearestOnly = 1,     // has no traversals for any hit
    kReadsUvs = 2,        // texture coordinates also where the scene has no texture
    kRaySlots = 4,        // keeps a packet's rays in private memory, settings.ray_slots for each pixel
    kLimitRegisters = 8,  // a GPU gains by fewer registers than it takes: program_cache.cpp has the numbers
    kFrameQueues = 16,    // rays of the whole frame in queues: several kernels, which wavefront.hpp launches
    kVotes = 32           // the work-items of a warp decide together: cl/lanes/subgroup.h
};

struct KernelRow {
    KernelKind kind;
    bool (*applies)(const KernelChoice&);  // null: always. Of a kind's rows the first that applies is taken
    const char* what;                      // for messages: "ray queries"
    const char* file;                      // below cl/, included last
    const char* entry;                     // name of the kernel function
    std::vector<const char*> headers;      // below cl/, included after the traversals and before `file`
    std::vector<std::string> defines;      // "NAME" or "NAME VALUE", ahead of all includes
    unsigned traits;
    rt_u32 needs;            // capabilities that the structure must have: RT_TRAVERSES_STEPS...
    unsigned rays_per_item;  // of kernels that trace a warp's rays together; else 0
    bool has(unsigned trait) const { return (traits & trait) != 0; }
};

const std::vector<KernelRow>& kernel_table();
const KernelRow& kernel_row(const KernelChoice& choice);

}  // namespace clarity
