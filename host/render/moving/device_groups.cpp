#include "render/moving/device_groups.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "device/kernel_files.hpp"
#include "plugin/extensions.hpp"
#include "plugin/host_services.hpp"
#include "render/device_build/device_blocks.hpp"

namespace clarity {
namespace {

constexpr uint64_t kBoxBytes = 6 * sizeof(float);
constexpr uint64_t kLeavesOfSerial = 4096;  // elements of a work-group that is one work-item
constexpr uint64_t kCostGroups = 512;       // work-groups that add the costs of nodes, at most

cl::Buffer copy_of(const BuildKernels& kernels, const cl::Buffer& from) {
    const auto bytes = from.getInfo<CL_MEM_SIZE>();
    cl::Buffer copy = kernels.buffer(bytes);
    kernels.device().queue().enqueueCopyBuffer(from, copy, 0, 0, bytes);
    return copy;
}

}  // namespace

DeviceGroups::DeviceGroups(const BuildKernels& kernels, std::shared_ptr<const AccelData> built,
                           std::shared_ptr<const DeviceScene> on_device, const DevicePose& pose)
    : kernels_(kernels),
      built_(std::move(built)),
      on_device_(std::move(on_device)),
      pose_(pose),
      layout_(device_build_of(*built_->layout)),
      params_(built_->layout == built_->plugin ? built_->params : default_parameters(*built_->layout)) {
    cannot_ = find_groups();
    if (!cannot_.empty()) return;
    make_scratch();
    program_ = kernels.compile(kernel_text("rt_shared.h") + kernel_text("rt_types.h") + "#line 1 \"cl/build/move.cl\"\n" +
                                   kernel_text("build/move.cl"),
                               "build/move.cl");
}

// Finds the nodes and leaves of each group. Returns why the structure cannot be refitted on the device; empty: it can.
std::string DeviceGroups::find_groups() {
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
        const Group group{found.first_element, found.element_count, root[0], root[1]};
        for (uint64_t e = group.first_element; e < group.first_element + group.element_count; ++e)
            if (ranges[2 * e + 1] > 0) ranges[2 * e] -= group.first_leaf;
        groups_.push_back(group);
        leaves += group.count;
    }
    if (leaves != built_->leaf_count) return name + " has leaves that no group has";
    ranges_ = kernels_.buffer(8 * counts[0]);
    kernels_.device().queue().enqueueWriteBuffer(ranges_, CL_TRUE, 0, 8 * counts[0], ranges.data());
    return {};
}

void DeviceGroups::make_scratch() {
    uint64_t count = 0, elements = 0;
    for (const Group& group : groups_) {
        count = std::max(count, group.count);
        elements = std::max(elements, group.element_count);
    }
    boxes_ = kernels_.buffer(count * sizeof(rt_prim));
    blocks_ = kernels_.buffer(DeviceBlocks::bytes(count));
    node_costs_ = kernels_.buffer(elements * sizeof(float));
    sums_ = kernels_.buffer(kCostGroups * sizeof(float));
}

DeviceStructure::DeviceStructure(const DeviceGroups& groups) : groups_(groups) {
    const DeviceScene::Moving base = groups.on_device_->moving();
    buffers_.leaves = copy_of(groups.kernels_, base.leaves);
    buffers_.instances = copy_of(groups.kernels_, base.instances);
    buffers_.normals = copy_of(groups.kernels_, base.normals);
    for (const cl::Buffer& slot : base.slots) buffers_.slots.push_back(copy_of(groups.kernels_, slot));
    buffers_.bounds = groups.kernels_.buffer(kBoxBytes);
    scene_ = std::make_shared<const DeviceScene>(*groups.on_device_, buffers_);
    version.assign(groups.groups_.size(), 0);
    plans_.resize(groups.groups_.size());
}

std::unique_ptr<DevicePlan> DeviceStructure::plan(rt_u32 number) {
    const DeviceGroups& shared = groups_;
    const BuildKernels& kernels = shared.kernels_;
    const DeviceGroups::Group& group = shared.groups_[number];
    const uint64_t each = kernels.serial() ? kLeavesOfSerial : kernels.group();
    const auto groups_for = [&](uint64_t elements) { return (elements + each - 1) / each; };
    const DeviceScene::Fixed fixed = shared.on_device_->fixed();
    auto plan = std::make_unique<DevicePlan>(kernels);

    cl::Kernel move(shared.program_, "move_leaves");
    cl_uint at = 0;
    move.setArg(at++, buffers_.leaves);
    for (const uint64_t value : {uint64_t{group.first_leaf}, group.count, each, uint64_t{number > 0}})
        move.setArg(at++, static_cast<cl_uint>(value));
    for (const cl::Buffer& buffer :
         {shared.pose_.corners, shared.pose_.positions, shared.pose_.placements, shared.pose_.group_of_instance,
          shared.pose_.group_boxes, buffers_.instances, fixed.polygons, fixed.polygon_corners, shared.boxes_})
        move.setArg(at++, buffer);
    plan->add_step([&kernels, move, count = groups_for(group.count)] { kernels.launch(move, count); });
    const auto blocks = std::make_shared<DeviceBlocks>(kernels);
    plan->add_step([blocks, &shared, &group] { blocks->run(shared.boxes_, nullptr, group.count, shared.blocks_); });
    cl::Kernel keep(shared.program_, "keep_group_box");
    keep.setArg(0, shared.blocks_);
    keep.setArg(1, static_cast<cl_uint>(group.count));
    keep.setArg(2, number);
    keep.setArg(3, shared.pose_.group_boxes);
    plan->add_step([&kernels, keep] { kernels.launch(keep, 1); });

    const AccelData& built = *shared.built_;
    const rt_accel& accel = *built.layout->accel;
    std::vector<rt_u32> slots;
    std::vector<uint64_t> first(accel.slot_count, 0), counts(accel.slot_count, 0);
    first[0] = group.first_element;
    counts[0] = group.element_count;
    size_t on_device = 0;
    for (rt_u32 s = 0; s < accel.slot_count; ++s)
        slots.push_back(accel.slots[s].flags & RT_SLOT_HOST_ONLY ? RT_NONE : plan->add(buffers_.slots[on_device++]));
    rt_device_tree tree{};
    tree.struct_bytes = sizeof tree;
    tree.slot_count = accel.slot_count;
    tree.slots = slots.data();
    tree.first_element = first.data();
    tree.element_count = counts.data();
    tree.root = built.roots[number];
    tree.first_leaf = group.first_leaf;
    tree.count = group.count;
    tree.ranges = plan->add(shared.ranges_);
    plan->plan_refit(*built.layout, shared.layout_, tree, plan->add(shared.blocks_), plan->add(shared.node_costs_),
                     shared.params_.data());

    const uint64_t costs_each = std::max<uint64_t>(1024, (group.element_count + kCostGroups - 1) / kCostGroups);
    const uint64_t parts = (group.element_count + costs_each - 1) / costs_each;
    cl::Kernel add(shared.program_, "add_costs"), cost(shared.program_, "keep_cost");
    add.setArg(0, shared.node_costs_);
    add.setArg(1, static_cast<cl_uint>(group.element_count));
    add.setArg(2, static_cast<cl_uint>(costs_each));
    add.setArg(3, shared.sums_);
    plan->add_step([&kernels, add, parts] { kernels.launch(add, parts); });
    cost.setArg(0, shared.sums_);
    cost.setArg(1, static_cast<cl_uint>(parts));
    cost.setArg(2, number);
    cost.setArg(3, shared.pose_.group_boxes);
    cost.setArg(4, shared.pose_.costs);
    plan->add_step([&kernels, cost] { kernels.launch(cost, 1); });
    return plan;
}

void DeviceStructure::refit(rt_u32 number) {
    if (groups_.groups_[number].count > 0) {
        if (!plans_[number]) plans_[number] = plan(number);
        plans_[number]->run();
    }
    if (number == 0)
        groups_.kernels_.device().queue().enqueueCopyBuffer(groups_.pose_.group_boxes, buffers_.bounds, 0, 0, kBoxBytes);
}

void DeviceStructure::take_normals(rt_u32 first_vertex, rt_u32 vertex_count) {
    const size_t at = 12 * size_t{first_vertex}, bytes = 12 * size_t{vertex_count};
    groups_.kernels_.device().queue().enqueueCopyBuffer(groups_.pose_.normals, buffers_.normals, at, at, bytes);
}

}  // namespace clarity
