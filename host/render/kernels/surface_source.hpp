// surface_source.hpp -- writes the kernels of the models of surfaces that plugins bring, and the functions that choose among
// them.
#pragma once
#include "render/kernels/source_writer.hpp"
#include "rt_types.h"

namespace clarity {

// Writes rt_surface_eval_by() and rt_surface_sample_by() for the models in `lobes`, of Optics.
void write_surfaces(SourceWriter& out, rt_u32 lobes);

}  // namespace clarity
