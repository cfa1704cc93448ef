#include "structures/on_device/device_plan.hpp"

#include "base/error.hpp"
#include "base/progress.hpp"
#include "device/kernel_files.hpp"
#include "plugin/host_services.hpp"
#include "structures/on_device/device_blocks.hpp"
#include "structures/on_device/device_sort.hpp"

namespace clarity {
namespace {

constexpr uint64_t kBox = sizeof(rt_prim);

DevicePlan& plan_of(void* ctx) {
    return *static_cast<DevicePlan*>(ctx);
}

}  // namespace

// No exception may cross into a plugin: it is kept as text, and the call fails.
struct DevicePlan::Calls {
    template <class Work>
    static int32_t guarded(void* ctx, Work&& work) {
        DevicePlan& plan = plan_of(ctx);
        if (!plan.why_.empty()) return RT_FAILED;
        try {
            work(plan);
            return RT_OK;
        } catch (const cl::Error& e) {
            plan.why_ = std::string(e.what()) + " failed with OpenCL error " + std::to_string(e.err());
        } catch (const std::exception& e) {
            plan.why_ = e.what();
        }
        return RT_FAILED;
    }
    // bytes: that a step of the host's reads or writes there.
    static cl::Buffer known(DevicePlan& plan, rt_u32 number, uint64_t bytes = 0) {
        if (number >= plan.buffers_.size())
            throw Error(Exit::failed, "it named buffer " + std::to_string(number) + " of a plan that has " +
                                          std::to_string(plan.buffers_.size()));
        const uint64_t has = plan.buffers_[number].getInfo<CL_MEM_SIZE>();
        if (bytes > has)
            throw Error(Exit::failed, "a step would take " + std::to_string(bytes) + " bytes of buffer " +
                                          std::to_string(number) + ", which has " + std::to_string(has));
        return plan.buffers_[number];
    }
    static void step(DevicePlan& plan, std::function<void()> run) {
        if (plan.steps_.size() >= RT_DEVICE_STEPS)
            throw Error(Exit::failed, "it planned more than " + std::to_string(RT_DEVICE_STEPS) + " steps");
        plan.steps_.push_back(std::move(run));
    }
    static rt_u32 buffer(void* ctx, uint64_t bytes) {
        rt_u32 number = RT_NONE;
        guarded(ctx, [&](DevicePlan& plan) {
            if (plan.buffers_.size() >= RT_DEVICE_BUFFERS)
                throw Error(Exit::failed, "it asked for more than " + std::to_string(RT_DEVICE_BUFFERS) + " buffers");
            const cl::Buffer made = plan.kernels_.buffer(bytes);
            plan.kernels_.device().queue().enqueueFillBuffer(made, cl_uchar{0}, 0, made.getInfo<CL_MEM_SIZE>());
            number = plan.add(made);
            plan.bytes_ += bytes;
        });
        return number;
    }
    static int32_t launch(void* ctx, const char* name, rt_u32 groups, const rt_device_arg* args, rt_u32 count) {
        return guarded(ctx, [&](DevicePlan& plan) {
            cl::Kernel kernel;
            try {
                kernel = cl::Kernel(plan.program_, name);
                const auto declared = kernel.getInfo<CL_KERNEL_NUM_ARGS>();
                if (declared != count)
                    throw Error(Exit::failed, std::string("its kernel ") + name + " has " + std::to_string(declared) +
                                                  " arguments, but its plan gives " + std::to_string(count));
                for (rt_u32 i = 0; i < count; ++i) {
                    if (args[i].buffer == RT_NONE)
                        kernel.setArg(i, cl_uint{args[i].value});
                    else
                        kernel.setArg(i, known(plan, args[i].buffer));
                }
            } catch (const cl::Error& e) {
                throw Error(Exit::failed, std::string("its kernel ") + name + " cannot be planned: " + e.what() +
                                              " failed with OpenCL error " + std::to_string(e.err()));
            }
            if (groups > 0) step(plan, [&plan, kernel, groups] { plan.kernels_.launch(kernel, groups); });
        });
    }
    static int32_t fill(void* ctx, rt_u32 buffer, uint64_t words, rt_u32 value) {
        return guarded(ctx, [&](DevicePlan& plan) {
            const cl::Buffer filled = known(plan, buffer, 4 * words);
            if (words > 0)
                step(plan, [&plan, filled, words, value] {
                    plan.kernels_.device().queue().enqueueFillBuffer(filled, cl_uint{value}, 0, 4 * words);
                });
        });
    }
    static int32_t sort(void* ctx, rt_u32 keys, rt_u32 values, uint64_t count, rt_u32 bits) {
        return guarded(ctx, [&](DevicePlan& plan) {
            const cl::Buffer by = known(plan, keys, 8 * count), sorted = known(plan, values, 4 * count);
            if (bits < 1 || bits > 64)
                throw Error(Exit::failed, "it asked for a sort by " + std::to_string(bits) + " bits: keys have 64");
            if (count == 0) return;
            const auto sorter = std::make_shared<DeviceSort>(plan.kernels_, count, SortKeys::bits64);
            plan.bytes_ += sorter->bytes();
            step(plan, [sorter, by, sorted, count, bits] { sorter->run(by, sorted, count, bits); });
        });
    }
    static int32_t scan(void* ctx, rt_u32 data, uint64_t count) {
        return guarded(ctx, [&](DevicePlan& plan) {
            const cl::Buffer scanned = known(plan, data, 4 * count);
            if (count == 0) return;
            const auto scanner = std::make_shared<DeviceScan>(plan.kernels_, count);
            plan.bytes_ += scanner->bytes();
            step(plan, [scanner, scanned, count] { scanner->run(scanned, count); });
        });
    }
    static int32_t bounds(void* ctx, rt_u32 boxes, uint64_t count, rt_u32 result) {
        return guarded(ctx, [&](DevicePlan& plan) {
            const cl::Buffer reduced = known(plan, boxes, kBox * count), to = known(plan, result, 12 * sizeof(float));
            const auto reducer = std::make_shared<DeviceReduce>(plan.kernels_);
            plan.bytes_ += reducer->bytes();
            step(plan, [reducer, reduced, count, to] { reducer->run(reduced, 0, count, to); });
        });
    }
    static int32_t curve(void* ctx, rt_u32 boxes, uint64_t count, rt_u32 axis_bits, rt_u32 keys, rt_u32 order) {
        return guarded(ctx, [&](DevicePlan& plan) {
            const cl::Buffer from = known(plan, boxes, kBox * count), to_keys = known(plan, keys, 8 * count),
                             to_order = known(plan, order, 4 * count);
            if (axis_bits < 1 || axis_bits > 21)
                throw Error(Exit::failed,
                            "it asked for a curve of " + std::to_string(axis_bits) + " bits an axis: 1 to 21 fit");
            const auto curve = std::make_shared<DeviceCurve>(plan.kernels_, count, axis_bits);
            plan.bytes_ += curve->bytes();
            step(plan, [=] { curve->run(from, count, to_keys, to_order); });
        });
    }
    static rt_u32 blocks(void* ctx, rt_u32 boxes, rt_u32 order, uint64_t count) {
        rt_u32 number = RT_NONE;
        guarded(ctx, [&](DevicePlan& plan) {
            const cl::Buffer from = known(plan, boxes, kBox * count),
                             places = order == RT_NONE ? from : known(plan, order, 4 * count);
            const cl::Buffer made = plan.kernels_.buffer(DeviceBlocks::bytes(count));
            plan.bytes_ += DeviceBlocks::bytes(count);
            number = plan.add(made);
            const auto blocks = std::make_shared<DeviceBlocks>(plan.kernels_);
            const bool ordered = order != RT_NONE;
            step(plan,
                 [blocks, from, places, ordered, count, made] { blocks->run(from, ordered ? &places : nullptr, count, made); });
        });
        return number;
    }
};

DevicePlan::DevicePlan(const BuildKernels& kernels) : kernels_(kernels) {}
DevicePlan::~DevicePlan() = default;

rt_u32 DevicePlan::add(const cl::Buffer& buffer) {
    buffers_.push_back(buffer);
    return static_cast<rt_u32>(buffers_.size() - 1);
}

void DevicePlan::plan(const rt_plugin& plugin, const rt_device_build& build,
                      const std::function<int32_t(const rt_host*, const rt_device_plan*)>& call) {
    const std::string name = std::string("accel ") + plugin.id;
    program_ = kernels_.compile(
        "#line 1 \"" + plugin_kernel_name(plugin, build.kernels) + "\"\n" + plugin_kernel_text(plugin, build.kernels),
        "build of " + name);
    rt_device_plan table{};
    table.struct_bytes = sizeof table;
    table.group_items = kernels_.group();
    table.units = kernels_.device().info().compute_units;
    table.has_warps = kernels_.warps();
    table.ctx = this;
    table.buffer = Calls::buffer;
    table.launch = Calls::launch;
    table.fill = Calls::fill;
    table.sort = Calls::sort;
    table.scan = Calls::scan;
    table.bounds = Calls::bounds;
    table.blocks = Calls::blocks;
    table.curve = Calls::curve;
    why_.clear();
    Progress progress;
    HostServices services(name, progress);
    const int32_t returned = call(services.host(), &table);
    if (returned == RT_OK && why_.empty()) return;
    const std::string why = !why_.empty() ? why_ : services.failed() ? services.why() : "it failed without a reason";
    throw Error(Exit::failed, name + ", planning a build on " + kernels_.device().info().name + ": " + why);
}

rt_device_topology DevicePlan::plan_topology(const rt_plugin& plugin, const rt_device_build& build,
                                             const rt_device_input& input) {
    rt_device_topology result{};
    result.struct_bytes = sizeof result;
    result.root = RT_NONE;
    plan(plugin, build,
         [&](const rt_host* host, const rt_device_plan* table) { return build.topology(host, table, &input, &result); });
    return result;
}

PlannedLayout DevicePlan::plan_layout(const rt_plugin& plugin, const rt_device_build& build, const rt_device_input& input,
                                      const rt_device_topology& topology, const rt_device_tree& tree, rt_u32 leaves) {
    PlannedLayout result;
    rt_device_output out{};
    out.struct_bytes = sizeof out;
    out.leaves = leaves;
    out.ctx = &result;
    out.root = [](void* ctx, rt_u32 node) { static_cast<PlannedLayout*>(ctx)->root = node; };
    out.define = [](void* ctx, const char* name, rt_u32 value) { static_cast<PlannedLayout*>(ctx)->defines[name] = value; };
    plan(plugin, build, [&](const rt_host* host, const rt_device_plan* table) {
        return build.pack(host, table, &input, &topology, &tree, &out);
    });
    return result;
}

void DevicePlan::plan_refit(const rt_plugin& plugin, const rt_device_build& build, const rt_device_tree& tree, rt_u32 blocks,
                            rt_u32 costs, const double* params) {
    plan(plugin, build, [&](const rt_host* host, const rt_device_plan* table) {
        return build.refit(host, table, &tree, blocks, costs, params);
    });
}

void DevicePlan::run() {
    for (const std::function<void()>& step : steps_) step();
}

}  // namespace clarity
