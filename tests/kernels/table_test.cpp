// The tables of kernels: every tracer's row is complete, settings choose among them, and arguments are found by their names.
#include <gtest/gtest.h>

#include <set>

#include "base/error.hpp"
#include "device/cl_errors.hpp"
#include "device/kernel_files.hpp"
#include "kernels/kernel_arguments.hpp"
#include "kernels/kernel_source.hpp"
#include "kernels/layout.hpp"
#include "structures/accel_build.hpp"
#include "support/errors.hpp"
#include "support/scenes.hpp"
#include "support/workbench.hpp"
#include "tracers/rays/ray_kernels.hpp"
#include "tracers/tracer.hpp"
#include "view/settings/aov.hpp"

namespace clarity {
namespace {

Settings one_pixel() {
    Settings settings;
    settings.tracer = "iterative";
    settings.lanes = settings.packet_w = settings.packet_h = 1;
    return settings;
}

// The kernels of all settings that choose one.
std::set<const KernelRow*> all_rows() {
    std::set<const KernelRow*> rows{&plain_rays(), &counted_rays(), &all_hits()};
    rows.insert(ray_kernels_of_structures().begin(), ray_kernels_of_structures().end());
    for (const TracerChoice& choice : tracer_choices())
        for (const Aov& aov : aov_table())
            for (const bool cpu : {false, true}) {
                Settings settings = one_pixel();
                settings.tracer = choice.id;
                settings.aov = aov.name;
                rows.insert(&tracer_of(settings).kernel(settings, make_layout(settings, cpu)));
            }
    return rows;
}

TEST(KernelTable, EveryRowNamesExistingFiles) {
    EXPECT_GE(all_rows().size(), 11u);
    for (const KernelRow* row : all_rows()) {
        const std::string text = kernel_text(row->file);
        EXPECT_FALSE(argument_names(text, row->entry, {}).empty()) << row->file << " has no " << row->entry;
        for (const char* header : row->headers) EXPECT_NO_THROW(kernel_text(header)) << header << " of " << row->entry;
        EXPECT_EQ(std::string(find_tracer(row->tracer).id), row->tracer);
        EXPECT_NE(std::string(row->what), "");
    }
}

TEST(KernelTable, FilesLieInTheFolderOfTheirTracer) {
    for (const Tracer* tracer : tracers()) EXPECT_TRUE(tracer->kernel || tracer->smoke) << tracer->id;
    for (const KernelRow* row : all_rows()) {
        const std::string id = row->tracer, folder = id == "counted_rays" || id == "all_hits" ? "rays" : id;
        EXPECT_EQ(std::string(row->file).rfind("tracers/" + folder + "/", 0), 0u) << row->file;
    }
}

TEST(KernelTable, ColorsByTracerAndLayout) {
    Settings settings = one_pixel();
    const Layout gpu = make_layout(settings, false), cpu = make_layout(settings, true);
    const auto row = [&](const char* tracer, const Layout& layout) -> const KernelRow& {
        settings.tracer = tracer;
        return tracer_of(settings).kernel(settings, layout);
    };
    EXPECT_EQ(std::string(row("iterative", gpu).entry), "trace_iterative");
    EXPECT_EQ(std::string(row("wavefront", gpu).entry), "trace_wavefront");
    EXPECT_EQ(std::string(row("iterative", gpu).headers.back()), "tracers/iterative/iterative_single.h");
    EXPECT_EQ(std::string(row("iterative", cpu).headers.back()), "tracers/iterative/generations.h");
}

// Local memory is shared by work-items, so a work-group of one needs none. PoCL 6.0 ends the process at a local variable that
// no instruction uses. With the optimiser, which removes such ones, that depends on what it finds.
TEST(KernelTable, WorkGroupsOfOneHaveNoLocalMemory) {
    Device& device = *test::Workbench::get().shared_device();
    if (!device.info().traces_packets()) GTEST_SKIP() << "SKIPPED: kernels for CPUs";
    const auto scene = test::load_scene(test::source_file("scenes/showpiece.scene"));
    const rt_plugin& plugin = *test::Workbench::get().plugins().accel("bvh2");
    Progress progress;
    const AccelData data = build_accel(*scene, plugin, default_parameters(plugin), progress);
    std::set<const KernelRow*> rows{&plain_rays(), &all_hits()};
    for (const TracerChoice& choice : tracer_choices()) {
        Settings settings = one_pixel();
        settings.tracer = choice.id;
        rows.insert(&tracer_of(settings).kernel(settings, make_layout(settings, true)));
    }
    size_t kernels = 0;
    for (const KernelRow* row : rows) {
        Settings settings = test::make_settings({{"accel", "bvh2"}, {"lanes", "4"}});
        resolve_packet(settings, device.info());
        const KernelSource source = kernel_for(*row, settings, make_layout(settings, true), *scene, data);
        wrap_cl_errors(device, "asking for local memory", [&] {
            cl::Program program(device.context(), source.text);
            program.build(device.info().cl_device, (source.options + " -cl-opt-disable").c_str());
            std::vector<cl::Kernel> all;
            program.createKernels(&all);
            for (const cl::Kernel& kernel : all) {
                if (kernel.getWorkGroupInfo<CL_KERNEL_COMPILE_WORK_GROUP_SIZE>(device.info().cl_device)[0] != 1) continue;
                EXPECT_EQ(kernel.getWorkGroupInfo<CL_KERNEL_LOCAL_MEM_SIZE>(device.info().cl_device), 0u)
                    << row->file << ": " << kernel.getInfo<CL_KERNEL_FUNCTION_NAME>();
                ++kernels;
            }
            return 0;
        });
    }
    EXPECT_GE(kernels, 5u);
}

TEST(KernelTable, LayoutsWantSettingsThatAreResolved) {
    Settings settings = test::make_settings({{"lanes", "4"}});
    EXPECT_THROW(make_layout(settings, true), std::logic_error);
    DeviceInfo info;
    info.cpu = true;
    resolve_packet(settings, info);
    EXPECT_EQ(make_layout(settings, true).packet_w, static_cast<unsigned>(settings.packet_w));
}

// A finished frame of one tracer that `auto` takes serves as one of another.
TEST(Tracers, WhatAutoTakesShowsTheSamePicture) {
    for (const Tracer* tracer : tracers())
        if (tracer->merit) {
            EXPECT_EQ(tracer->picture, picture_of_tracer("auto")) << tracer->id;
        }
    for (const TracerChoice& choice : tracer_choices()) EXPECT_NE(std::string(choice.picture), "") << choice.id;
    DeviceInfo gpu;
    gpu.gpu = true;
    Scene scene;
    EXPECT_EQ(std::string(automatic_tracer(gpu, scene).id), "wavefront");
    scene.materials.push_back({"glass", default_material()});
    scene.materials.back().values.refract = 1;
    EXPECT_EQ(std::string(automatic_tracer(gpu, scene).id), "iterative");
}

using Names = std::vector<std::string>;

TEST(KernelArguments, AreReadFromTheDeclaration) {
    const std::string text = R"(
/* trace_x(uint a) { is called by nobody */
float before_trace_x(float y) { return y; }
kernel void __attribute__((reqd_work_group_size(1, 1, 1)))
trace_x (const constant rt_frame *frame, const uint /* of, the launch */ first_group, // the film, in sums
         volatile global uint *list, RT_OVERFLOWS_PARAM RT_CTX_PARAMS)
{
    call_trace_x(frame);
})";
    EXPECT_EQ(argument_names(text, "trace_x", {{"RT_CTX_PARAMS", "ctx_leaves, ctx_planes"}, {"RT_OVERFLOWS_PARAM", ""}}),
              (Names{"frame", "first_group", "list", "ctx_leaves", "ctx_planes"}));
    EXPECT_EQ(argument_names(text, "trace_x", {{"RT_OVERFLOWS_PARAM", "overflows,"}, {"RT_CTX_PARAMS", "ctx_leaves"}}),
              (Names{"frame", "first_group", "list", "overflows", "ctx_leaves"}));
    EXPECT_EQ(argument_names(text, "trace", {}), Names());
    EXPECT_EQ(argument_names(text, "rt_frame", {}), Names());
    for (const std::string broken : {"trace_x(", "trace_x(uint a", "trace_x(uint a)", "/* trace_x(uint a) {", "// trace_x", ""})
        EXPECT_EQ(argument_names(broken, "trace_x", {}), Names()) << broken;
}

TEST(KernelArguments, OneThatIsNotDeclaredIsNamed) {
    KernelArguments kernel(cl::Kernel(), {"frame"}, "cl/tracers/x/x.cl: kernel trace_x");
    EXPECT_TRUE(kernel.has("frame"));
    EXPECT_FALSE(kernel.has("fram"));
    expect_error([&] { kernel.set("film", cl_uint(0)); }, {"cl/tracers/x/x.cl: kernel trace_x has no argument `film`"},
                 Exit::kernel_build_failed);
}

// Kernels of several lanes do not compile for GPUs.
TEST(Layout, OnlyCpusTakeSeveralLanes) {
    DeviceInfo cpu, gpu;
    cpu.cpu = gpu.gpu = true;
    gpu.name = "a GPU";
    for (const int lanes : {0, 1, 4, 16}) {
        Settings settings;
        settings.lanes = lanes;
        EXPECT_NO_THROW(resolve_packet(settings, cpu)) << lanes;
        settings.lanes = lanes;
        if (lanes <= 1) {
            resolve_packet(settings, gpu);
            EXPECT_EQ(settings.lanes, 1);
            continue;
        }
        expect_error([&] { resolve_packet(settings, gpu); }, {"a GPU computes work-items side by side"}, Exit::usage);
    }
}

}  // namespace
}  // namespace clarity
