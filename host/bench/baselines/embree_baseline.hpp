// embree_baseline.hpp -- Embree 3 as a baseline.
#pragma once
#include "bench/baselines/baseline.hpp"

namespace clarity::bench {

std::unique_ptr<BaselineScene> build_embree(const BaselineMesh& mesh, const std::string& quality, unsigned threads);

}  // namespace clarity::bench
