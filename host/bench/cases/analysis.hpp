// analysis.hpp -- turns the counters of packets into figures per ray.
#pragma once
#include <vector>

#include "bench/output/record.hpp"
#include "bench/suites/ray_sets.hpp"
#include "render/tracers/rays/ray_query.hpp"

namespace clarity::bench {

// `hits`: results of `rays`, traced with RayQuery::count in packets of `lanes`; `work`: RayQuery::work of them. node_bytes:
// size of one node in bytes.
Analysis analyze(const std::vector<rt_ray>& rays, const std::vector<rt_hit>& hits, const std::vector<RayWork>& work,
                 unsigned lanes, unsigned node_bytes);

}  // namespace clarity::bench
