// path.hpp -- what other kernels that trace paths of light share with the tracer `path`.
#pragma once
#include <vector>

namespace clarity {

// The headers of its kernel, below cl/. recorder: those of what records paths; they come before the state of paths.
std::vector<const char*> path_headers(const std::vector<const char*>& recorder = {});

}  // namespace clarity
