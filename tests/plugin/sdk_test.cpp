// The C++ helpers of the SDK, tested with the real host services.
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>

#include "base/error.hpp"
#include "plugin/host_services.hpp"
#include "rt_device.hpp"
#include "rt_plugin.hpp"

namespace {

// The host's error text after a guarded function; "" for success.
template <auto F>
std::string outcome(clarity::Progress& progress) {
    clarity::HostServices services("plugin", progress);
    try {
        services.check(1, [&] { return rt::guarded<F>(services.host(), 5); });
    } catch (const clarity::Error& e) {
        return e.what();
    }
    return "";
}
template <auto F>
std::string outcome() {
    clarity::Progress progress;
    return outcome<F>(progress);
}

int32_t succeeds(const rt_host*, int number) {
    return number == 5 ? RT_OK : RT_FAILED;
}
int32_t throws(const rt_host*, int) {
    throw std::runtime_error("vertex 7 is not finite");
}
int32_t throws_number(const rt_host*, int) {
    throw 7;
}
int32_t runs_out_of_memory(const rt_host*, int) {
    throw std::bad_alloc();
}
int32_t fails(const rt_host* host, int) {
    throw rt::fail(host, "face 3 has no corners");
}
int32_t reports(const rt_host* host, int) {
    rt::progress(host, 0.5f);
    return RT_OK;
}
int32_t throws_in_loop(const rt_host* host, int) {
    rt::parallel_for(host, 100, [](rt_u32 i) {
        if (i == 42) throw std::runtime_error("iteration 42");
    });
    return RT_OK;
}
int32_t loops(const rt_host* host, int) {
    std::atomic<rt_u32> sum{0};
    rt::parallel_for(host, 10, [&](rt_u32 i) { rt::parallel_for(host, 10, [&](rt_u32 j) { sum += i * 10 + j; }); });
    return sum == 4950 ? int32_t{RT_OK} : host->fail(host->ctx, "wrong sum");
}

TEST(Guarded, PassesArgumentsAndStatusOn) {
    EXPECT_EQ(outcome<succeeds>(), "");
    EXPECT_EQ(outcome<loops>(), "");
}

TEST(Guarded, TurnsExceptionsIntoReasons) {
    EXPECT_EQ(outcome<throws>(), "plugin: vertex 7 is not finite");
    EXPECT_EQ(outcome<throws_number>(), "plugin: an exception of unknown type");
    EXPECT_EQ(outcome<runs_out_of_memory>(), "plugin: out of memory");
    EXPECT_EQ(outcome<throws_in_loop>(), "plugin: iteration 42");
}

TEST(Guarded, FailKeepsItsOwnReason) {
    EXPECT_EQ(outcome<fails>(), "plugin: face 3 has no corners");
}

TEST(Guarded, CancelIsNoFailure) {
    clarity::Progress progress;
    EXPECT_EQ(outcome<reports>(progress), "");
    progress.cancel();
    EXPECT_EQ(outcome<reports>(progress), "cancelled");
}

// If the host has no memory, it has recorded that already, so the helper only stops the build.
TEST(BuildOutput, NoMemoryStopsTheBuild) {
    rt_build_output out{};
    out.alloc = [](void*, rt_u32, uint64_t) -> void* { return nullptr; };
    out.leaves = [](void*, uint64_t) -> rt_u32* { return nullptr; };
    EXPECT_THROW(rt::alloc<float>(&out, 0, 1), rt::Stopped);
    EXPECT_THROW(rt::leaves(&out, 1), rt::Stopped);
    EXPECT_THROW(rt::id(RT_NONE), rt::Stopped);
    EXPECT_EQ(rt::id(3), 3u);
}

// All parts of a description must be constants, because the host reads its head from the file before any code runs.
constexpr rt_cl_file kFiles[] = {{"a_types.h", "types"}, {"a.cl", "text"}};
static_assert(rt::file(kFiles, "a.cl").text == kFiles[1].text);
static_assert(rt::file(kFiles, "a").name == nullptr && rt::file(kFiles, "a.clx").name == nullptr);
constexpr rt_slot kSlots[] = {rt::slot<rt_packed_prim>("leaves", "rt_packed_prim")};
static_assert(kSlots[0].elem_bytes == 48);
constexpr const char* kChoices[] = {"one", "two", "three", nullptr};
constexpr rt_param kParams[] = {rt::enum_param("which", "Which", "of three", kChoices, 2)};
static_assert(kParams[0].min == 0 && kParams[0].max == 2 && kParams[0].def == 2);
constexpr rt_accel kAccel =
    rt::accel(kSlots, kFiles[0], kFiles[1], nullptr, nullptr,
              rt::Traits().can(RT_TRAVERSES_STEPS).can(RT_TRAVERSES_WARPS).merit(0.5f, 2).tests_everything());
static_assert(kAccel.struct_bytes == sizeof(rt_accel) && kAccel.slot_count == 1 && kAccel.slots == kSlots && !kAccel.pack &&
              kAccel.kernel_contract == RT_KERNEL_CONTRACT && kAccel.slot_bytes == sizeof(rt_slot) && !kAccel.layout);
static_assert(kAccel.types.text == kFiles[0].text && kAccel.traverse.text == kFiles[1].text);
static_assert(kAccel.capabilities == (RT_TRAVERSES_STEPS | RT_TRAVERSES_WARPS) && kAccel.merit_cpu == 0.5f &&
              kAccel.merit_gpu == 2 && kAccel.ray_cost == RT_RAY_COST_LINEAR);
static_assert(rt::host_slot<rt_prim>("boxes").elem_bytes == 32 && rt::host_slot<rt_prim>("boxes").flags == RT_SLOT_HOST_ONLY);
constexpr rt_accel kTopology = rt::topology("bvh2", nullptr, rt::Traits().merit(0.5f, 2));
static_assert(kTopology.struct_bytes == sizeof(rt_accel) && kTopology.layout[0] == 'b' && kTopology.slot_count == 0 &&
              !kTopology.build && !kTopology.pack && kTopology.merit_gpu == 2 && kTopology.ray_cost == RT_RAY_COST_LOGARITHMIC);
constexpr rt_plugin kPlugin = rt::accel_plugin("a", "A", "1", nullptr, kParams, kAccel);
static_assert(kPlugin.abi_version == RT_ABI_VERSION && kPlugin.param_count == 1 && kPlugin.accel == &kAccel &&
              !kPlugin.importer && kPlugin.param_bytes == sizeof(rt_param) && !kPlugin.extensions);
// The extension refit is frozen: fields are appended behind these.
static_assert(sizeof(rt_refit) == 16 && offsetof(rt_refit, refit) == 8);
static_assert(sizeof(rt_refit_input) == 72 && offsetof(rt_refit_input, changed) == 8 && offsetof(rt_refit_input, roots) == 16 &&
              offsetof(rt_refit_input, slot_counts) == 24 && offsetof(rt_refit_input, leaf_count) == 32 &&
              offsetof(rt_refit_input, params) == 40 && offsetof(rt_refit_input, ctx) == 48 &&
              offsetof(rt_refit_input, prims) == 56 && offsetof(rt_refit_input, leaves) == 64);
static_assert(sizeof(rt_refit_output) == 32 && offsetof(rt_refit_output, slots) == 8 && offsetof(rt_refit_output, ctx) == 16 &&
              offsetof(rt_refit_output, cost) == 24);
constexpr rt_refit kRefit = rt::refit(nullptr);
constexpr rt_extension kRefits[] = {rt::extension(kRefit), rt::kNoMoreExtensions};
static_assert(kRefits[0].version == 1 && kRefits[0].data_bytes == 16 && kRefits[1].name == nullptr);

// So is the extension device_build.
static_assert(sizeof(rt_device_arg) == 8 && offsetof(rt_device_arg, value) == 4);
static_assert(sizeof(rt_device_plan) == 88 && offsetof(rt_device_plan, group_items) == 4 &&
              offsetof(rt_device_plan, units) == 8 && offsetof(rt_device_plan, has_warps) == 12 &&
              offsetof(rt_device_plan, ctx) == 16 && offsetof(rt_device_plan, buffer) == 24 &&
              offsetof(rt_device_plan, launch) == 32 && offsetof(rt_device_plan, fill) == 40 &&
              offsetof(rt_device_plan, sort) == 48 && offsetof(rt_device_plan, scan) == 56 &&
              offsetof(rt_device_plan, bounds) == 64 && offsetof(rt_device_plan, blocks) == 72 &&
              offsetof(rt_device_plan, curve) == 80);
static_assert(sizeof(rt_device_input) == 24 && offsetof(rt_device_input, prims) == 4 && offsetof(rt_device_input, count) == 8 &&
              offsetof(rt_device_input, params) == 16);
static_assert(sizeof(rt_device_topology) == 24 && offsetof(rt_device_topology, nodes) == 4 &&
              offsetof(rt_device_topology, counts) == 8 && offsetof(rt_device_topology, order) == 12 &&
              offsetof(rt_device_topology, depth) == 16 && offsetof(rt_device_topology, root) == 20);
static_assert(sizeof(rt_device_tree) == 56 && offsetof(rt_device_tree, slot_count) == 4 &&
              offsetof(rt_device_tree, slots) == 8 && offsetof(rt_device_tree, first_element) == 16 &&
              offsetof(rt_device_tree, element_count) == 24 && offsetof(rt_device_tree, root) == 32 &&
              offsetof(rt_device_tree, first_leaf) == 36 && offsetof(rt_device_tree, count) == 40 &&
              offsetof(rt_device_tree, ranges) == 48);
static_assert(sizeof(rt_device_output) == 32 && offsetof(rt_device_output, leaves) == 4 &&
              offsetof(rt_device_output, ctx) == 8 && offsetof(rt_device_output, root) == 16 &&
              offsetof(rt_device_output, define) == 24);
static_assert(sizeof(rt_tree_ranges) == 32 && offsetof(rt_tree_ranges, first_element) == 8 &&
              offsetof(rt_tree_ranges, element_count) == 16 && offsetof(rt_tree_ranges, ranges) == 24);
static_assert(sizeof(rt_device_build) == 64 && offsetof(rt_device_build, kernels) == 8 &&
              offsetof(rt_device_build, topology) == 24 && offsetof(rt_device_build, elements) == 32 &&
              offsetof(rt_device_build, pack) == 40 && offsetof(rt_device_build, ranges) == 48 &&
              offsetof(rt_device_build, refit) == 56);
constexpr rt_device_build kDeviceBuild = rt::device_topology(kFiles[1], nullptr);
constexpr rt_extension kDeviceBuilds[] = {rt::extension(kDeviceBuild), rt::kNoMoreExtensions};
static_assert(kDeviceBuilds[0].version == 1 && kDeviceBuilds[0].data_bytes == 64 &&
              kDeviceBuild.kernels.text == kFiles[1].text);

constexpr rt_extension kExtensions[] = {{"org.example.paint", 2, 0, nullptr}, {nullptr, 0, 0, nullptr}};
static_assert(rt::with_extensions(kPlugin, kExtensions).extensions == kExtensions &&
              rt::with_extensions(kPlugin, kExtensions).extension_bytes == sizeof(rt_extension));

}  // namespace
