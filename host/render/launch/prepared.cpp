#include "render/launch/prepared.hpp"

#include "render/kernels/program_cache.hpp"
#include "render/view/view_optics.hpp"

namespace clarity {

bool Prepared::knows(const View& view) const {
    const Optics known = optics_of(*scene) | settings.optics;
    return optics_known(program->row, known).covers(optics_known(program->row, optics_of(*scene, view, settings)));
}

}  // namespace clarity
