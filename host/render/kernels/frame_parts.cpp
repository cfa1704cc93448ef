#include "render/kernels/frame_parts.hpp"

namespace clarity {

std::shared_ptr<const Prepared> FrameParts::prepare(const Prepared& whole, FramePart part) {
    auto less = std::make_shared<Prepared>(whole);
    if (part == FramePart::whole) return less;
    const KernelSource source =
        assemble_kernel(whole.settings, whole.layout, KernelKind::color, features_of(*whole.scene, whole.accel->scene),
                        *whole.accel->plugin, whole.accel->defines, part);
    bool fresh = false;
    less->program = programs_.get(source, KernelKind::color,
                                  std::string("a part of a frame with accel ") + whole.accel->plugin->id, &fresh);
    return less;
}

}  // namespace clarity
