// shape_source.hpp -- writes the kernels of the shapes that a scene has, and the functions that choose among them.
#pragma once
#include "render/kernels/source_writer.hpp"
#include "scene/scene.hpp"

namespace clarity {

// Writes rt_shape_hit() and rt_shape_surface_at(), with the kernels of the kinds that occur. rt_ctx must be written already.
void write_shapes(SourceWriter& out, const Scene& scene);

}  // namespace clarity
