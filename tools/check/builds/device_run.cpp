#include "tools/check/builds/device_run.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "base/error.hpp"
#include "plugin/capabilities.hpp"
#include "plugin/host_services.hpp"
#include "structures/judging.hpp"

namespace clarity::check {
namespace {

constexpr uint64_t kBefore = 37, kBehind = 29;  // elements beside a tree in its slot
constexpr uint64_t kFirstLeaf = 11;
constexpr unsigned char kUntouched = 0xA5;

template <class T>
std::vector<T> download(const BuildKernels& kernels, const cl::Buffer& buffer, uint64_t count) {
    std::vector<T> values(count);
    if (count > 0) kernels.device().queue().enqueueReadBuffer(buffer, CL_TRUE, 0, count * sizeof(T), values.data());
    return values;
}
template <class T>
void upload(const BuildKernels& kernels, const cl::Buffer& buffer, const std::vector<T>& values) {
    if (!values.empty())
        kernels.device().queue().enqueueWriteBuffer(buffer, CL_TRUE, 0, values.size() * sizeof(T), values.data());
}
template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}
uint64_t room(const DevicePlan& plan, rt_u32 number, const char* what) {
    try {
        return plan.buffer(number).getInfo<CL_MEM_SIZE>();
    } catch (const std::out_of_range&) {
        throw Error(Exit::failed, std::string("it did not say where its ") + what + " are: rt_device_topology names buffer " +
                                      std::to_string(number));
    }
}

}  // namespace

TopologyRun::TopologyRun(const BuildKernels& kernels, const rt_plugin& plugin, size_t count)
    : kernels_(kernels), params_(default_parameters(plugin)), count_(count), plan_(kernels) {
    prims_ = kernels.buffer(count * sizeof(rt_prim));
    const rt_device_input input{sizeof input, plan_.add(prims_), count, params_.data()};
    tree_ = plan_.plan_topology(plugin, device_build_of(plugin), input);
    const uint64_t nodes = count > 1 ? count - 1 : 0;
    if (room(plan_, tree_.order, "places in `order`") < 4 * count ||
        (nodes > 0 && (room(plan_, tree_.nodes, "nodes") < nodes * sizeof(rt_topology_node) ||
                       room(plan_, tree_.counts, "counts") < 4 * nodes)))
        throw Error(Exit::failed, "the buffers of its tree are too small for " + std::to_string(count) + " primitives");
}

Problem TopologyRun::run(const std::vector<rt_prim>& prims, std::vector<rt_u32>& leaves) {
    upload(kernels_, prims_, prims);
    plan_.run();
    DeviceTree tree;
    const uint64_t nodes = count_ > 1 ? count_ - 1 : 0;
    tree.order = download<rt_u32>(kernels_, plan_.buffer(tree_.order), count_);
    tree.depth = tree_.depth;
    if (nodes > 0) {
        tree.nodes = download<rt_topology_node>(kernels_, plan_.buffer(tree_.nodes), nodes);
        tree.counts = download<rt_u32>(kernels_, plan_.buffer(tree_.counts), nodes);
        if (tree_.root != RT_NONE) tree.root = download<rt_u32>(kernels_, plan_.buffer(tree_.root), 1)[0];
    }
    if (!same_bytes(download<rt_prim>(kernels_, prims_, count_), prims)) return "wrote to the primitives";
    return tree_fault(tree, prims, leaves);
}

LayoutRun::LayoutRun(const BuildKernels& kernels, const rt_plugin& plugin, size_t count, rt_u32 depth)
    : kernels_(kernels),
      plugin_(plugin),
      build_(device_build_of(plugin)),
      params_(default_parameters(plugin)),
      count_(count),
      first_leaf_(kFirstLeaf),
      pack_(kernels),
      refit_(kernels) {
    for (rt_u32 s = 0; s < plugin.accel->slot_count; ++s) {
        const uint64_t most = build_.elements(s, count, params_.data());
        if (most > 64 * uint64_t{count} + 1024 || (s == 0 && most == 0))
            throw Error(Exit::failed, "`elements` says " + std::to_string(most) + " elements of slot " +
                                          plugin.accel->slots[s].name + " for " + std::to_string(count) + " primitives");
        first_.push_back(kBefore);
        elements_.push_back(most);
        all_.push_back(kBefore + most + kBehind);
    }
    make_slots(nullptr);
    prims_ = kernels.buffer(count * sizeof(rt_prim));
    nodes_ = kernels.buffer(count * sizeof(rt_topology_node));
    counts_ = kernels.buffer(4 * count);
    order_ = kernels.buffer(4 * count);
    root_buffer_ = kernels.buffer(4);
    const rt_device_input input{sizeof input, pack_.add(prims_), count, params_.data()};
    const rt_device_topology topology{sizeof topology, pack_.add(nodes_),      pack_.add(counts_), pack_.add(order_),
                                      depth,           pack_.add(root_buffer_)};
    std::vector<rt_u32> numbers;
    const rt_device_tree tree = tree_in(pack_, numbers);
    const PlannedLayout planned = pack_.plan_layout(plugin, build_, input, topology, tree, pack_.add(leaves_));
    root_ = planned.root;
    if (root_ < kBefore || root_ >= kBefore + elements_[0])
        throw Error(Exit::failed, root_ == RT_NONE
                                      ? std::string("`pack` reported no root")
                                      : "`pack` reported root " + std::to_string(root_) + ", but the tree has elements " +
                                            std::to_string(kBefore) + " to " + std::to_string(kBefore + elements_[0] - 1));
    plan_refit();
}

LayoutRun::LayoutRun(const BuildKernels& kernels, const rt_plugin& plugin, const BuilderResult& built, rt_u32 group,
                     Problem& why)
    : kernels_(kernels),
      plugin_(plugin),
      build_(device_build_of(plugin)),
      params_(default_parameters(plugin)),
      root_(built.roots[group]),
      pack_(kernels),
      refit_(kernels) {
    std::vector<const void*> memory;
    for (const BuilderResult::Slot& slot : built.slots) {
        memory.push_back(slot.memory.data());
        all_.push_back(slot.count);
    }
    const rt_built table{sizeof table, static_cast<rt_u32>(built.roots.size()), memory.data(), all_.data(), built.roots.data()};
    std::vector<rt_u32> ranges(2 * all_[0]);
    rt_tree_ranges found{sizeof found, 0, 0, 0, ranges.data()};
    Progress progress;
    HostServices services(plugin.id, progress);
    if (build_.ranges(services.host(), &table, group, &found) != RT_OK) {
        why = "`ranges` failed: " + services.why();
        return;
    }
    first_.assign(all_.size(), 0);
    elements_.assign(all_.size(), 0);
    first_[0] = found.first_element;
    elements_[0] = found.element_count;
    if (first_[0] > all_[0] || elements_[0] > all_[0] - first_[0] || root_ < first_[0] || root_ - first_[0] >= elements_[0]) {
        why = "`ranges` says that the nodes are " + std::to_string(elements_[0]) + " from " + std::to_string(first_[0]) +
              " on: slot 0 has " + std::to_string(all_[0]) + " elements, the root is " + std::to_string(root_);
        return;
    }
    first_leaf_ = ranges[2 * size_t{root_}];
    count_ = ranges[2 * size_t{root_} + 1];
    for (uint64_t e = 0; e < all_[0]; ++e) {
        const uint64_t first = ranges[2 * e], count = ranges[2 * e + 1];
        if (count == 0) continue;
        if (e < first_[0] || e >= first_[0] + elements_[0] || first < first_leaf_ || first + count > first_leaf_ + count_) {
            why = "`ranges` gives element " + std::to_string(e) + " of slot 0 " + std::to_string(count) + " positions from " +
                  std::to_string(first) + " on: it is not in the group, or its positions are not among those of the root";
            return;
        }
        ranges[2 * e] -= static_cast<rt_u32>(first_leaf_);
    }
    make_slots(&built);
    upload(kernels, ranges_, ranges);
    plan_refit();
}

void LayoutRun::make_slots(const BuilderResult* built) {
    const rt_accel& accel = *plugin_.accel;
    for (rt_u32 s = 0; s < accel.slot_count; ++s) {
        const uint64_t bytes = all_[s] * accel.slots[s].elem_bytes;
        buffers_.push_back(kernels_.buffer(bytes));
        if (built && bytes > 0)
            kernels_.device().queue().enqueueWriteBuffer(buffers_.back(), CL_TRUE, 0, bytes, built->slots[s].memory.data());
        else if (bytes > 0)
            upload(kernels_, buffers_.back(), std::vector<unsigned char>(bytes, kUntouched));
    }
    ranges_ = kernels_.buffer(8 * all_[0]);
    upload(kernels_, ranges_, std::vector<rt_u32>(2 * all_[0], 0));
    leaves_ = kernels_.buffer(4 * count_);
    leaf_prims_ = kernels_.buffer(count_ * sizeof(rt_prim));
    costs_ = kernels_.buffer(4 * elements_[0]);
}

rt_device_tree LayoutRun::tree_in(DevicePlan& plan, std::vector<rt_u32>& numbers) const {
    const rt_accel& accel = *plugin_.accel;
    for (rt_u32 s = 0; s < accel.slot_count; ++s)
        numbers.push_back(accel.slots[s].flags & RT_SLOT_HOST_ONLY ? RT_NONE : plan.add(buffers_[s]));
    rt_device_tree tree{};
    tree.struct_bytes = sizeof tree;
    tree.slot_count = accel.slot_count;
    tree.slots = numbers.data();
    tree.first_element = first_.data();
    tree.element_count = elements_.data();
    tree.root = root_;
    tree.first_leaf = static_cast<rt_u32>(first_leaf_);
    tree.count = count_;
    tree.ranges = plan.add(ranges_);
    return tree;
}

void LayoutRun::plan_refit() {
    const cl::Buffer blocks = kernels_.buffer(DeviceBlocks::bytes(count_));
    const auto maker = std::make_shared<DeviceBlocks>(kernels_);
    refit_.add_step([=] { maker->run(leaf_prims_, nullptr, count_, blocks); });
    std::vector<rt_u32> numbers;
    const rt_device_tree tree = tree_in(refit_, numbers);
    refit_.plan_refit(plugin_, build_, tree, refit_.add(blocks), refit_.add(costs_), params_.data());
}

std::vector<std::vector<unsigned char>> LayoutRun::slots() const {
    std::vector<std::vector<unsigned char>> bytes;
    for (rt_u32 s = 0; s < buffers_.size(); ++s)
        bytes.push_back(download<unsigned char>(kernels_, buffers_[s], all_[s] * plugin_.accel->slots[s].elem_bytes));
    return bytes;
}

Problem LayoutRun::written_outside(const std::vector<std::vector<unsigned char>>& before) const {
    const auto after = slots();
    for (size_t s = 0; s < after.size(); ++s) {
        const uint64_t size = plugin_.accel->slots[s].elem_bytes;
        for (uint64_t i = 0; i < after[s].size(); ++i) {
            const uint64_t element = i / size;
            if (after[s][i] == before[s][i] || (element >= first_[s] && element < first_[s] + elements_[s])) continue;
            return "wrote to element " + std::to_string(element) + " of slot " + plugin_.accel->slots[s].name +
                   ", but the tree has elements " + std::to_string(first_[s]) + " to " +
                   std::to_string(first_[s] + elements_[s] - 1);
        }
    }
    return {};
}

Problem LayoutRun::ranges_fault() const {
    const auto ranges = download<rt_u32>(kernels_, ranges_, 2 * all_[0]);
    for (uint64_t e = 0; e < all_[0]; ++e) {
        const uint64_t first = ranges[2 * e], count = ranges[2 * e + 1];
        if (count > 0 && (e < first_[0] || e >= first_[0] + elements_[0] || first + count > count_))
            return "wrote to the ranges that element " + std::to_string(e) + " of slot 0 has " + std::to_string(count) +
                   " positions from " + std::to_string(first) + " on: it is no element of the tree, or there are " +
                   std::to_string(count_) + " positions";
    }
    if (ranges[2 * size_t{root_}] != 0 || ranges[2 * size_t{root_} + 1] != count_)
        return "wrote to the ranges that the root has " + std::to_string(ranges[2 * size_t{root_} + 1]) +
               " positions, but the tree has " + std::to_string(count_);
    return {};
}

Problem LayoutRun::pack(const std::vector<rt_prim>& prims, const DeviceTree& tree, std::vector<rt_u32>& leaves) {
    upload(kernels_, prims_, prims);
    upload(kernels_, nodes_, tree.nodes);
    upload(kernels_, counts_, tree.counts);
    upload(kernels_, order_, tree.order);
    upload(kernels_, root_buffer_, std::vector<rt_u32>{tree.root});
    const auto before = slots();
    pack_.run();
    if (!same_bytes(download<rt_prim>(kernels_, prims_, count_), prims)) return "wrote to the primitives";
    leaves = download<rt_u32>(kernels_, leaves_, count_);
    if (const Problem why = order_fault(leaves)) return "wrote a leaf order that " + why.text();
    if (const Problem why = written_outside(before)) return why;
    return ranges_fault();
}

Problem LayoutRun::refit(const std::vector<rt_prim>& prims) {
    upload(kernels_, leaf_prims_, prims);
    upload(kernels_, costs_, std::vector<float>(elements_[0], NAN));
    const auto before = slots();
    refit_.run();
    const auto costs = download<float>(kernels_, costs_, elements_[0]);
    for (uint64_t e = 0; e < costs.size(); ++e)
        if (std::isnan(costs[e]) || costs[e] < 0)
            return "gave element " + std::to_string(first_[0] + e) + " of slot 0 the cost " + std::to_string(costs[e]);
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY}, extent[3];
    for (const rt_prim& prim : prims)
        for (int k = 0; k < 3; ++k) lo[k] = std::min(lo[k], double(prim.lo[k])), hi[k] = std::max(hi[k], double(prim.hi[k]));
    for (int k = 0; k < 3; ++k) extent[k] = hi[k] - lo[k];
    const double area = extent[0] * extent[1] + extent[1] * extent[2] + extent[2] * extent[0];
    // Beyond these areas the products of floats, by which the device computes costs, are 0 or infinite.
    cost_ = area > 1e-20 && area < 1e20 ? std::accumulate(costs.begin(), costs.end(), 0.0) / area : -1;
    return written_outside(before);
}

BuilderResult LayoutRun::result() const {
    BuilderResult result;
    const auto bytes = slots();
    for (size_t s = 0; s < bytes.size(); ++s) {
        BuilderResult::Slot slot;
        slot.memory = GuardedBytes(bytes[s].size(), std::string("slot ") + plugin_.accel->slots[s].name);
        if (!bytes[s].empty()) std::memcpy(slot.memory.data(), bytes[s].data(), bytes[s].size());
        slot.count = all_[s];
        result.slots.push_back(std::move(slot));
    }
    result.roots = {root_};
    return result;
}

}  // namespace clarity::check
