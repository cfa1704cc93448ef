#include "render/moving/on_device/device_groups.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "device/kernel_files.hpp"
#include "plugin/extensions.hpp"
#include "plugin/host_services.hpp"
#include "render/device_build/device_blocks.hpp"

namespace clarity {

DeviceGroups::DeviceGroups(const BuildKernels& kernels, std::shared_ptr<const AccelData> built,
                           std::shared_ptr<const DeviceScene> on_device, const DevicePose& pose)
    : kernels_(kernels),
      built_(std::move(built)),
      on_device_(std::move(on_device)),
      pose_(pose),
      layout_(device_build_of(*built_->layout)),
      builder_(device_build_of(*built_->plugin)),
      params_(built_->layout == built_->plugin ? built_->params : default_parameters(*built_->layout)) {
    cannot_ = find_groups();
    if (cannot_) return;
    place_trees();
    make_scratch();
    program_ = kernels.compile(kernel_text("rt_shared.h") + kernel_text("rt_types.h") + "#line 1 \"cl/build/move.cl\"\n" +
                                   kernel_text("build/move.cl"),
                               "build/move.cl");
}

// Finds the nodes and leaves of each group. Returns why the structure cannot be refitted on the device; nothing: it can.
Problem DeviceGroups::find_groups() {
    const std::string name = std::string("accel ") + built_->layout->id;
    if (!layout_.refit || !layout_.ranges) return name + " does not offer a refit on the device";
    if (kernels_.device().info().cl_device.getInfo<CL_DEVICE_EXTENSIONS>().find("cl_khr_fp64") == std::string::npos)
        return kernels_.device().info().name + " has no numbers of double precision";
    std::vector<const void*> slots;
    std::vector<uint64_t> counts;
    for (const AccelData::Slot& slot : built_->slots) {
        slots.push_back(slot.memory.data());
        counts.push_back(slot.count);
    }
    const rt_built table = {sizeof(rt_built), static_cast<rt_u32>(built_->roots.size()), slots.data(), counts.data(),
                            built_->roots.data()};
    UninitializedVector<rt_u32> ranges(2 * counts.at(0));
    std::fill(ranges.begin(), ranges.end(), 0);
    Progress progress;
    HostServices services(name, progress);
    uint64_t leaves = 0;
    for (rt_u32 g = 0; g < table.group_count; ++g) {
        rt_tree_ranges found{sizeof(rt_tree_ranges), 0, 0, 0, ranges.data()};
        if (layout_.ranges(services.host(), &table, g, &found) != RT_OK)
            return name + " cannot be refitted on the device: " + services.why();
        if (found.first_element + found.element_count > counts[0] || built_->roots[g] >= counts[0])
            return name + " names nodes behind its slot (a fault of the plugin)";
        const rt_u32* const root = &ranges[2 * size_t{built_->roots[g]}];
        Group group;
        group.at_rest.first.assign(slots.size(), 0);
        group.at_rest.count.assign(slots.size(), 0);
        group.at_rest.first[0] = found.first_element;
        group.at_rest.count[0] = found.element_count;
        group.first_leaf = root[0];
        group.count = root[1];
        for (uint64_t e = found.first_element; e < found.first_element + found.element_count; ++e)
            if (ranges[2 * e + 1] > 0) ranges[2 * e] -= group.first_leaf;
        groups_.push_back(group);
        leaves += group.count;
    }
    if (leaves != built_->leaf_count) return name + " has leaves that no group has";
    ranges_ = kernels_.buffer(8 * counts[0]);
    kernels_.device().queue().enqueueWriteBuffer(ranges_, CL_TRUE, 0, 8 * counts[0], ranges.data());
    return {};
}

// Trees that the device builds stand behind those that the host has built.
void DeviceGroups::place_trees() {
    for (const AccelData::Slot& slot : built_->slots) slot_elements_.push_back(slot.count);
    if (!can_build()) return;
    for (Group& group : groups_)
        for (rt_u32 s = 0; s < slot_elements_.size(); ++s) {
            group.built.first.push_back(slot_elements_[s]);
            group.built.count.push_back(layout_.elements(s, group.count, params_.data()));
            slot_elements_[s] += group.built.count.back();
        }
}

void DeviceGroups::make_scratch() {
    uint64_t count = 0, elements = 0;
    for (const Group& group : groups_) {
        count = std::max(count, group.count);
        elements = std::max(elements, group.at_rest.count[0]);
        if (can_build()) elements = std::max(elements, group.built.count[0]);
    }
    if (can_build()) {
        boxes_ = kernels_.buffer(count * sizeof(rt_prim));
        order_ = kernels_.buffer(count * sizeof(rt_u32));
        old_leaves_ = kernels_.buffer(count * sizeof(rt_packed_prim));
    }
    blocks_ = kernels_.buffer(DeviceBlocks::bytes(count));
    node_costs_ = kernels_.buffer(elements * sizeof(float));
    sums_ = kernels_.buffer(kCostGroups * sizeof(float));
}

}  // namespace clarity
