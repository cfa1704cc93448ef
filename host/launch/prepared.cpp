#include "launch/prepared.hpp"

#include "base/error.hpp"
#include "kernels/program_cache.hpp"
#include "launch/device_scene.hpp"
#include "view/view.hpp"

namespace clarity {

bool Prepared::knows(const View& view) const {
    const Optics known = optics_of(*scene) | settings.optics;
    return optics_known(program->row, known).covers(optics_known(program->row, optics_of(*scene, view, settings)));
}

uint64_t Prepared::device_bytes() const {
    return on_device->bytes();
}

void Prepared::expect_known(const View& view) const {
    if (!knows(view))
        throw Error(
            Exit::failed,
            "tracing: the view has kinds of lights or surfaces that the kernels were not compiled for: prepare the scene "
            "with the view's optics in the settings");
}

}  // namespace clarity
