// load_trial.hpp -- opens a library in a worker process before this process does. The dynamic loader and a library's
// constructors run at once; a damaged file crashes them.
#pragma once
#include <string>

#include "base/problem.hpp"
#include "worker/job.hpp"

namespace clarity {

// Opens and checks a library without trust (trust.hpp) in a worker. Returns nothing if that worker came to
// an end, or could not be started; otherwise how it died: the library must then not be opened here. Thread-safe.
Problem try_to_load(const std::string& path);

extern const worker::JobKind kLoadJob;

}  // namespace clarity
