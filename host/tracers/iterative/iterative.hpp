// iterative.hpp -- what the tracer that goes from generation to generation shares with the inspector, which records its rays.
#pragma once
#include "kernels/kernel_row.hpp"

namespace clarity {

// The headers for packets whose rays lie in arrays of private memory. recorded: with those of the recorder.
std::vector<const char*> headers_by_generations(bool recorded);
// Defines RT_RAY_SLOTS, the room of these arrays for each pixel.
void define_ray_slots(SourceWriter& out, const Settings& settings);

}  // namespace clarity
