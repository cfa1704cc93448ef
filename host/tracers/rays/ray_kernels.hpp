// ray_kernels.hpp -- the kernels of ray queries.
#pragma once
#include "kernels/kernel_row.hpp"

namespace clarity {

constexpr unsigned kRequeueItems = 32;  // work-items that trace one long ray together: a warp

// One block of lanes after the other; with counters of steps and leaf tests.
const KernelRow& plain_rays();
const KernelRow& counted_rays();
// All hits of each ray, kHitsAtOnce of them in a launch.
constexpr unsigned kHitsAtOnce = 8;
const KernelRow& all_hits();
// Of one lane, in two launches: long rays are traced again by many work-items.
const KernelRow& requeued_rays();
// Of one lane: a work-item that is done fetches another ray. Nearest hits only.
const KernelRow& dynamic_fetch();
// Kernels of one lane that a structure may offer: these two, and those in which all rays of a warp visit the same nodes, with
// one and with two rays a work-item.
const std::vector<const KernelRow*>& ray_kernels_of_structures();

}  // namespace clarity
