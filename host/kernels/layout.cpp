#include "kernels/layout.hpp"

#include <algorithm>
#include <stdexcept>

#include "base/error.hpp"

namespace clarity {
namespace {

constexpr unsigned kMostRays = 32768;  // of one generation of a packet: 2.6 MB of private memory
constexpr unsigned kDefaultRays = 8192;

}  // namespace

void resolve_packet(Settings& settings, const DeviceInfo& info) {
    if (settings.lanes == 0) settings.lanes = static_cast<int>(info.preferred_lanes());
    // Several lanes need a CPU that runs one work-item after the other (cl/lanes/lanes.h). Kernels of several lanes do not
    // compile for a GPU. Mesa 22.3 was still compiling one after 100 s, with 1.3 GiB of memory.
    if (!info.traces_packets() && settings.lanes > 1)
        throw Error(Exit::usage, "--lanes " + std::to_string(settings.lanes) + ": " + info.name +
                                     " computes work-items side by side, so each traces one ray: take --lanes 1");
    if (settings.packet_w == 0)  // on a CPU a packet stream: cl/lanes/packet_stream.h
        settings.packet_w = settings.packet_h = info.traces_packets() ? std::max(4, settings.lanes) : 1;
}

Layout make_layout(const Settings& settings, bool cpu) {
    if (settings.lanes <= 0 || settings.packet_w <= 0 || settings.packet_h <= 0)
        throw std::logic_error("make_layout: resolve_packet() has not chosen lanes and packet yet");
    Layout layout;
    layout.lanes = static_cast<unsigned>(settings.lanes);
    layout.packet_w = static_cast<unsigned>(settings.packet_w);
    layout.packet_h = static_cast<unsigned>(settings.packet_h);
    // A block has 4x4, 4x2 or 2x2 pixels. A narrow packet gets a narrower and taller block of as many.
    layout.block_w = layout.lanes >= 8 ? 4 : layout.lanes == 4 ? 2 : 1;
    layout.block_h = layout.lanes / layout.block_w;
    while (layout.block_w >= 2 * layout.packet_w && layout.block_h < layout.packet_h) layout.block_w /= 2, layout.block_h *= 2;
    while (layout.block_h >= 2 * layout.packet_h && layout.block_w < layout.packet_w) layout.block_h /= 2, layout.block_w *= 2;

    const unsigned pixels = layout.packet_w * layout.packet_h, slots = static_cast<unsigned>(settings.ray_slots);
    if (pixels * slots > kMostRays)
        throw Error(Exit::usage, "packet " + std::to_string(layout.packet_w) + "x" + std::to_string(layout.packet_h) +
                                     " with ray_slots " + std::to_string(slots) + " needs room for " +
                                     std::to_string(pixels * slots) + " rays a work-item, of " + std::to_string(kMostRays) +
                                     " at most: take a smaller packet or fewer ray slots");
    layout.max_pixels = 1;
    while (layout.max_pixels < pixels) layout.max_pixels *= 2;
    layout.cpu = cpu && !(settings.portable && layout.lanes == 1);  // `portable` lets tests without a GPU run the code for GPUs
    if (!layout.cpu) return layout;                                 // a group is 64 neighbours; a warp has 8x4 of them
    // Room for large packets from the start, so that a larger packet compiles nothing. It costs nothing: a CPU touches only the
    // part of its stack that it uses.
    layout.group_side = 4;
    // As RT_IN_GROUP of cl/tracers/camera.h.
    const auto in_group = [&](unsigned packet_side) { return std::clamp(16 / packet_side, 1u, layout.group_side); };
    layout.group_w = in_group(layout.packet_w);
    layout.group_h = in_group(layout.packet_h);
    layout.max_pixels = std::max(layout.max_pixels, std::min(1024u, kDefaultRays / slots));
    return layout;
}

PixelPlace Layout::place_of(unsigned x, unsigned y, unsigned width) const {
    const unsigned packet_x = x / packet_w, packet_y = y / packet_h;
    return {packet_y / group_h * groups_x(width) + packet_x / group_w, packet_y % group_h * group_w + packet_x % group_w,
            y % packet_h * packet_w + x % packet_w};
}

}  // namespace clarity
