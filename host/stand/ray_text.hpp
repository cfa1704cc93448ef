// ray_text.hpp -- rays as lines of numbers, and their answers: the files of `clarity trace`.
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "rt_types.h"

namespace clarity {

struct AllHits;
struct RayWork;

// Reads a ray a line: origin x y z, t_min, direction x y z, t_max, separated by white space or commas. `inf` and `nan` are
// numbers, too. Text after # is a comment; lines without numbers are skipped. Throws Error(usage) "FILE:LINE:COLUMN: why".
// file: for messages.
// origins: if given, gets the rays' origins in double precision.
using RayOrigins = std::vector<std::array<double, 3>>;
std::vector<rt_ray> parse_rays(std::string_view text, const std::string& file, RayOrigins* origins = nullptr);
// The same from a file; "-" is stdin. Throws Error(failed) if it cannot be read.
std::vector<rt_ray> read_rays(const std::string& path, RayOrigins* origins = nullptr);

// The line that parse_rays() reads as this ray: all digits.
std::string ray_text(const rt_ray& ray);

// A line a hit, after a line with the names of the columns: t, prim, instance, u, v; for any-hit queries: occluded, 1 or 0.
// work: of each ray, if it was counted; then nodes, boxes and tests follow.
std::string hits_text(const std::vector<rt_hit>& hits, bool any_hit, const std::vector<RayWork>& work);
// The same for all hits, with the number of the ray in front, from 0 on; and a number a ray: how many hits it has.
std::string all_hits_text(const AllHits& all);
std::string counts_text(const AllHits& all);

}  // namespace clarity
