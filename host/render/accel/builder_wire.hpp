// builder_wire.hpp -- passes a builder's input to a worker process and its result back, in shared memory.
#pragma once
#include <memory>
#include <string>

#include "render/accel/guarded_build.hpp"
#include "rt_plugin.h"

namespace clarity {

// Writes the input into an empty file in memory. tree: what is to be packed; nullptr: nothing. Returns an empty text on
// success, otherwise the reason; so do the others.
std::string write_builder_input(int fd, const rt_build_input& input, uint64_t prim_count, rt_u32 param_count,
                                const rt_topology* tree);
// Reads it in the worker.
std::string read_builder_input(int fd, std::unique_ptr<BuilderInput>& input);

// Appends the result behind the input.
std::string write_builder_result(int fd, const BuilderResult& result);
// Reads what the worker wrote, and calls the functions of `out` as the builder did. The worker is not trusted: every size is
// checked. It must have ended, so that nothing changes.
std::string replay_builder_result(int fd, const rt_accel& accel, rt_u32 group_count, const rt_build_output& out);

}  // namespace clarity
