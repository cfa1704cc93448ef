// layout.hpp -- how a picture is divided into work-groups, packets and blocks of rays. It follows from settings and device, is
// made once for each Prepared, and is kept there. All code that sizes a buffer or finds a pixel in one uses it.
#pragma once
#include <cstddef>

#include "device/device.hpp"
#include "view/settings/settings.hpp"

namespace clarity {

// Where a pixel is computed.
struct PixelPlace {
    unsigned group;   // number of its work-group, row by row over the picture
    unsigned packet;  // number of its packet within the group
    unsigned pixel;   // number of the pixel within the packet, row by row
};

// The first four members are compiled into kernels. The others are in rt_frame, or follow from what is there.
struct Layout {
    unsigned lanes = 1;
    bool cpu = false;                     // a work-group is one work-item, which traces its packets in turn
    unsigned group_side = 8;              // packets of a work-group in each direction, at most
    unsigned max_pixels = 1;              // a packet has at most so many pixels
    unsigned packet_w = 1, packet_h = 1;  // pixels of a work-item
    unsigned group_w = 8, group_h = 8;    // packets of a work-group
    unsigned block_w = 1, block_h = 1;    // pixels of a block, traced together; block_w * block_h = lanes
    unsigned groups_x(unsigned width) const { return (width + packet_w * group_w - 1) / (packet_w * group_w); }
    unsigned groups_y(unsigned height) const { return (height + packet_h * group_h - 1) / (packet_h * group_h); }
    unsigned blocks_x() const { return (packet_w + block_w - 1) / block_w; }
    unsigned blocks() const { return blocks_x() * ((packet_h + block_h - 1) / block_h); }
    unsigned rays() const { return blocks() * lanes; }  // camera rays of a packet, its blocks' pixels outside it included
    unsigned group_packets() const { return group_w * group_h; }
    unsigned local_size() const { return cpu ? 1 : group_packets(); }
    // The packets of a picture of this size in pixels, including those that reach beyond its edges.
    size_t packets(unsigned width, unsigned height) const {
        return size_t(groups_x(width)) * groups_y(height) * group_packets();
    }
    unsigned row_height() const { return group_h * packet_h; }  // pixels; of a row of work-groups
    PixelPlace place_of(unsigned x, unsigned y, unsigned width) const;
};
// Chooses lanes and the packet's size where they are `auto`, as suits the device. Throws Error(usage) for lanes that its
// compiler cannot do.
void resolve_packet(Settings& settings, const DeviceInfo& info);
// cpu: DeviceInfo::traces_packets(). In `settings`, packet and lanes must be resolved. Throws Error(usage) if packet x
// ray_slots needs more private memory than devices have.
Layout make_layout(const Settings& settings, bool cpu);

}  // namespace clarity
