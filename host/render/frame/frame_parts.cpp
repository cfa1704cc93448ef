#include "render/frame/frame_parts.hpp"

namespace clarity {

std::shared_ptr<const Prepared> FrameParts::prepare(const Prepared& whole, FramePart part) {
    auto less = std::make_shared<Prepared>(whole);
    if (part == FramePart::whole) return less;
    less->program = programs_.get(kernel_for(whole, KernelKind::color, part));
    return less;
}

}  // namespace clarity
