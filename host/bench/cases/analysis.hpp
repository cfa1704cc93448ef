// analysis.hpp -- turns the counters of packets into figures per ray.
#pragma once
#include <vector>

#include "bench/output/record.hpp"
#include "bench/suites/ray_sets.hpp"

namespace clarity::bench {

// `hits`: results of `rays`, traced with RayQuery::count in packets of `lanes`. node_bytes: size of one node in bytes.
Analysis analyze(const std::vector<rt_ray>& rays, const std::vector<rt_hit>& hits, unsigned lanes, unsigned node_bytes);

}  // namespace clarity::bench
