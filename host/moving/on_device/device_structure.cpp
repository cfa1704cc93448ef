#include "moving/on_device/device_structure.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "device/kernel_files.hpp"
#include "plugin/capabilities.hpp"
#include "plugin/host_services.hpp"
#include "structures/on_device/device_blocks.hpp"

namespace clarity {
namespace {

constexpr uint64_t kCostsAlone = 4096;    // nodes whose costs one work-group adds
constexpr uint64_t kSerialLeaves = 4096;  // leaves that a work-group of one work-item takes

// A copy of a buffer, with room for `bytes` at least.
cl::Buffer copy_of(const BuildKernels& kernels, const cl::Buffer& from, uint64_t bytes = 0) {
    const auto held = from.getInfo<CL_MEM_SIZE>();
    cl::Buffer copy = kernels.buffer(std::max<uint64_t>(held, bytes));
    kernels.device().queue().enqueueCopyBuffer(from, copy, 0, 0, held);
    return copy;
}

}  // namespace

DeviceStructure::DeviceStructure(const DeviceGroups& groups) : groups_(groups) {
    const BuildKernels& kernels = groups.kernels_;
    const DeviceScene::Moving base = groups.on_device_->moving();
    const rt_accel& accel = *groups.built_->layout->accel;
    buffers_.leaves = copy_of(kernels, base.leaves);
    buffers_.instances = copy_of(kernels, base.instances);
    buffers_.normals = copy_of(kernels, base.normals);
    for (rt_u32 s = 0, at = 0; s < accel.slot_count; ++s)
        if (!(accel.slots[s].flags & RT_SLOT_HOST_ONLY))
            buffers_.slots.push_back(copy_of(kernels, base.slots[at++], groups.slot_elements_[s] * accel.slots[s].elem_bytes));
    buffers_.bounds = kernels.buffer(6 * sizeof(float));
    roots_ = groups.built_->roots;
    buffers_.roots = kernels.buffer(roots_.size() * sizeof(rt_u32));
    kernels.device().queue().enqueueWriteBuffer(buffers_.roots, CL_TRUE, 0, roots_.size() * sizeof(rt_u32), roots_.data());
    ranges_ = groups.can_build() ? copy_of(kernels, groups.ranges_, 8 * groups.slot_elements_[0]) : groups.ranges_;
    scene_ = std::make_shared<const DeviceScene>(*groups.on_device_, buffers_);
    version.assign(groups.count(), 0);
    built_in.assign(groups.count(), 0);
    is_built_.assign(groups.count(), 0);
    built_roots_.assign(groups.count(), RT_NONE);
    plans_.resize(groups.count());
}

// The tree of a group as plugins see it. slots: receives the numbers of buffers, and must outlive the result.
rt_device_tree DeviceStructure::tree_of(rt_u32 number, bool built, DevicePlan& plan, std::vector<rt_u32>& slots) const {
    const DeviceGroups::Group& group = groups_.groups_[number];
    const rt_accel& accel = *groups_.built_->layout->accel;
    const DeviceGroups::Place& place = built ? group.built : group.at_rest;
    size_t on_device = 0;
    for (rt_u32 s = 0; s < accel.slot_count; ++s)
        slots.push_back(accel.slots[s].flags & RT_SLOT_HOST_ONLY ? RT_NONE : plan.add(buffers_.slots[on_device++]));
    rt_device_tree tree{};
    tree.struct_bytes = sizeof tree;
    tree.slot_count = accel.slot_count;
    tree.slots = slots.data();
    tree.first_element = place.first.data();
    tree.element_count = place.count.data();
    tree.root = built ? built_roots_[number] : groups_.built_->roots[number];
    tree.first_leaf = group.first_leaf;
    tree.count = group.count;
    tree.ranges = plan.add(ranges_);
    return tree;
}

// Steps: leaves and their blocks follow the pose.
void DeviceStructure::add_leaves(rt_u32 number, DevicePlan& plan) const {
    const DeviceGroups& shared = groups_;
    const BuildKernels& kernels = shared.kernels_;
    const DeviceGroups::Group& group = shared.groups_[number];
    const DeviceScene::Fixed fixed = shared.on_device_->fixed();
    cl::Kernel move(shared.program_, "move_leaves");
    cl_uint at = 0;
    move.setArg(at++, buffers_.leaves);
    for (const uint64_t value : {uint64_t{group.first_leaf}, group.count, uint64_t{number > 0}})
        move.setArg(at++, static_cast<cl_uint>(value));
    const DeviceBlocks::Whole whole = {shared.pose_.group_boxes, number, number == 0 ? buffers_.bounds : shared.sums_};
    for (const cl::Buffer& buffer : {shared.pose_.corners, shared.pose_.positions, shared.pose_.placements,
                                     shared.pose_.group_of_instance, shared.pose_.group_boxes, buffers_.roots,
                                     buffers_.instances, fixed.polygons, fixed.polygon_corners, shared.blocks_, whole.block})
        move.setArg(at++, buffer);
    move.setArg(at++, whole.at);
    move.setArg(at++, whole.bounds);
    const uint64_t tiles = (group.count + DeviceBlocks::kTile - 1) / DeviceBlocks::kTile;
    plan.add_step([&kernels, move, tiles] { kernels.launch(move, tiles); });
    const auto blocks = std::make_shared<DeviceBlocks>(kernels);
    plan.add_step([blocks, &shared, &group, whole] { blocks->run_above(group.count, shared.blocks_, whole); });
}

std::unique_ptr<DevicePlan> DeviceStructure::plan_refit(rt_u32 number, bool built) const {
    const DeviceGroups& shared = groups_;
    auto plan = std::make_unique<DevicePlan>(shared.kernels_);
    add_leaves(number, *plan);
    std::vector<rt_u32> slots;
    const rt_device_tree tree = tree_of(number, built, *plan, slots);
    plan->plan_refit(*shared.built_->layout, shared.layout_, tree, plan->add(shared.blocks_), plan->add(shared.node_costs_),
                     shared.params_.data());
    return plan;
}

std::unique_ptr<DevicePlan> DeviceStructure::plan_build(rt_u32 number) {
    const DeviceGroups& shared = groups_;
    const BuildKernels& kernels = shared.kernels_;
    const DeviceGroups::Group& group = shared.groups_[number];
    const DeviceScene::Fixed fixed = shared.on_device_->fixed();
    const uint64_t each = kernels.serial() ? kSerialLeaves : kernels.group(), groups = (group.count + each - 1) / each;
    const auto first = static_cast<cl_uint>(group.first_leaf), count = static_cast<cl_uint>(group.count);
    auto plan = std::make_unique<DevicePlan>(kernels);
    add_leaves(number, *plan);

    cl::Kernel boxes(shared.program_, "leaf_boxes");
    boxes.setArg(0, buffers_.leaves);
    boxes.setArg(1, first);
    boxes.setArg(2, count);
    boxes.setArg(3, static_cast<cl_uint>(each));
    boxes.setArg(4, fixed.polygons);
    boxes.setArg(5, fixed.polygon_corners);
    boxes.setArg(6, shared.boxes_);
    plan->add_step([&kernels, boxes, groups] { kernels.launch(boxes, groups); });

    const rt_u32 prims = plan->add(shared.boxes_), order = plan->add(shared.order_);
    const rt_device_input for_builder = {sizeof(rt_device_input), prims, group.count, shared.built_->params.data()},
                          for_layout = {sizeof(rt_device_input), prims, group.count, shared.params_.data()};
    std::vector<rt_u32> slots;
    const rt_device_tree tree = tree_of(number, true, *plan, slots);
    const rt_device_topology topology = plan->plan_topology(*shared.built_->plugin, shared.builder_, for_builder);
    const PlannedLayout planned = plan->plan_layout(*shared.built_->layout, shared.layout_, for_layout, topology, tree, order);
    built_roots_[number] = planned.root;
    for (const auto& [name, value] : planned.defines) defines_[name] = std::max(defines_[name], value);

    cl::Kernel reorder(shared.program_, "order_leaves");
    reorder.setArg(0, shared.old_leaves_);
    reorder.setArg(1, buffers_.leaves);
    reorder.setArg(2, shared.order_);
    reorder.setArg(3, first);
    reorder.setArg(4, count);
    reorder.setArg(5, static_cast<cl_uint>(each));
    const uint64_t at = first * sizeof(rt_packed_prim), bytes = count * sizeof(rt_packed_prim);
    plan->add_step([this, &kernels, reorder, groups, at, bytes] {
        kernels.device().queue().enqueueCopyBuffer(buffers_.leaves, groups_.old_leaves_, at, 0, bytes);
        kernels.launch(reorder, groups);
    });
    return plan;
}

std::unique_ptr<DevicePlan> DeviceStructure::plan_cost(rt_u32 number, bool built) const {
    const DeviceGroups& shared = groups_;
    const BuildKernels& kernels = shared.kernels_;
    const DeviceGroups::Group& group = shared.groups_[number];
    const uint64_t count = (built ? group.built : group.at_rest).count[0];
    auto plan = std::make_unique<DevicePlan>(kernels);
    cl::Buffer summed = shared.node_costs_;
    uint64_t left = count;
    if (count > kCostsAlone) {
        const uint64_t each = std::max(kCostsAlone, (count + DeviceGroups::kCostGroups - 1) / DeviceGroups::kCostGroups);
        left = (count + each - 1) / each;
        cl::Kernel add(shared.program_, "add_costs");
        add.setArg(0, summed);
        add.setArg(1, static_cast<cl_uint>(count));
        add.setArg(2, static_cast<cl_uint>(each));
        add.setArg(3, shared.sums_);
        plan->add_step([&kernels, add, left] { kernels.launch(add, left); });
        summed = shared.sums_;
    }
    cl::Kernel cost(shared.program_, "keep_cost");
    cost.setArg(0, summed);
    cost.setArg(1, static_cast<cl_uint>(left));
    cost.setArg(2, number);
    cost.setArg(3, shared.pose_.group_boxes);
    cost.setArg(4, shared.pose_.costs);
    plan->add_step([&kernels, cost] { kernels.launch(cost, 1); });
    return plan;
}

// Makes the tree that the host or the device has built that of the group.
void DeviceStructure::set_root(rt_u32 number, bool built) {
    is_built_[number] = built;
    const rt_u32 root = built ? built_roots_[number] : groups_.built_->roots[number];
    if (roots_[number] == root) return;
    roots_[number] = root;
    groups_.kernels_.device().queue().enqueueFillBuffer(buffers_.roots, cl_uint{root}, number * sizeof(rt_u32), sizeof(rt_u32));
}

void DeviceStructure::add_cost(rt_u32 number) {
    auto& plan = is_built_[number] ? plans_[number].cost_built : plans_[number].cost;
    if (!plan) plan = plan_cost(number, is_built_[number]);
    plan->run();
}

void DeviceStructure::refit(rt_u32 number, bool with_cost) {
    if (groups_.groups_[number].count == 0) {
        if (number == 0)
            groups_.kernels_.device().queue().enqueueCopyBuffer(groups_.pose_.no_bounds, buffers_.bounds, 0, 0,
                                                                6 * sizeof(float));
        return;
    }
    auto& plan = is_built_[number] ? plans_[number].refit_built : plans_[number].refit;
    if (!plan) plan = plan_refit(number, is_built_[number]);
    plan->run();
    if (with_cost) add_cost(number);
}

void DeviceStructure::build(rt_u32 number, bool with_cost) {
    if (groups_.groups_[number].count == 0) return refit(number, with_cost);
    if (!plans_[number].build) plans_[number].build = plan_build(number);
    plans_[number].build->run();
    set_root(number, true);
    if (with_cost) refit(number, true);  // the same boxes once more, which gives the cost
}

void DeviceStructure::take_tree(rt_u32 number, const DeviceStructure& from) {
    const DeviceGroups::Group& group = groups_.groups_[number];
    const rt_accel& accel = *groups_.built_->layout->accel;
    Queue& queue = groups_.kernels_.device().queue();
    const bool built = from.is_built_[number] != 0;
    const DeviceGroups::Place& place = built ? group.built : group.at_rest;
    const uint64_t leaves = group.count * sizeof(rt_packed_prim), first_leaf = group.first_leaf * sizeof(rt_packed_prim);
    if (leaves > 0) queue.enqueueCopyBuffer(from.buffers_.leaves, buffers_.leaves, first_leaf, first_leaf, leaves);
    size_t on_device = 0;
    for (rt_u32 s = 0; s < accel.slot_count; ++s) {
        if (accel.slots[s].flags & RT_SLOT_HOST_ONLY) continue;
        const uint64_t at = place.first[s] * accel.slots[s].elem_bytes, bytes = place.count[s] * accel.slots[s].elem_bytes;
        if (bytes > 0) queue.enqueueCopyBuffer(from.buffers_.slots[on_device], buffers_.slots[on_device], at, at, bytes);
        ++on_device;
    }
    if (built) queue.enqueueCopyBuffer(from.ranges_, ranges_, 8 * place.first[0], 8 * place.first[0], 8 * place.count[0]);
    built_roots_[number] = from.built_roots_[number];
    built_in[number] = from.built_in[number];
    set_root(number, built);
}

void DeviceStructure::take_normals(rt_u32 first_vertex, rt_u32 vertex_count) {
    const size_t at = 12 * size_t{first_vertex}, bytes = 12 * size_t{vertex_count};
    groups_.kernels_.device().queue().enqueueCopyBuffer(groups_.pose_.normals, buffers_.normals, at, at, bytes);
}

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
