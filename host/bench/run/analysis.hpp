// analysis.hpp -- from what packets counted to figures a ray.
#pragma once
#include <vector>

#include "bench/output/record.hpp"
#include "bench/suites/ray_sets.hpp"

namespace clarity::bench {

// hits: of rays, traced with RayQuery::count by packets of `lanes`. node_bytes: of one node.
Analysis analyze(const std::vector<rt_ray>& rays, const std::vector<rt_hit>& hits, unsigned lanes, unsigned node_bytes);

}  // namespace clarity::bench
