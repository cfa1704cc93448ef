// incoherent.hpp -- the parameter `incoherent`: how a CPU traces packets that diverge, and what `auto` chooses.
#pragma once
#include "clarity_bvh/parameters.hpp"

namespace bvh8 {

// How a CPU traces diverging packets: as packets, or as single rays.
constexpr int kIncoherent = clarity::bvh::kOwnParams;  // its place in the table of parameters
enum Incoherent { kAuto, kPackets, kSingle };
inline constexpr const char* kIncoherentWays[] = {"auto", "packets", "single", nullptr};
// Size from which packets that diverge are traced as single rays. Trees of about this size outgrow a core's own cache. Measured
// with diffuse rays and frames (docs/experiments.md) on Sapphire Rapids, with 2 MiB of that cache and a slow third level:
// models of up to 70'000 triangles are traced faster as packets. At 86'000 and 100'000 triangles, single rays are as fast from
// close by, and 1.1 to 1.3 times as fast from afar. At a million, single rays are 1.2 to 1.6 times as fast.
constexpr uint64_t kTogether = 75'000;  // primitives

}  // namespace bvh8
