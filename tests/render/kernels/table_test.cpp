// The table of kernels: every row is complete, and every kind of kernel has one.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "device/kernel_files.hpp"
#include "render/kernels/kernel_table.hpp"

namespace clarity {
namespace {

TEST(KernelTable, EveryRowNamesExistingFiles) {
    for (const KernelRow& row : kernel_table()) {
        const std::string text = kernel_text(row.file);
        EXPECT_NE(text.find(std::string(row.entry) + "("), std::string::npos) << row.file << " has no " << row.entry;
        for (const char* header : row.headers) EXPECT_NO_THROW(kernel_text(header)) << header << " of " << row.entry;
    }
}

TEST(KernelTable, EveryKindHasARow) {
    Settings settings;
    settings.lanes = settings.packet_w = settings.packet_h = 1;
    for (const bool cpu : {false, true}) {
        const Layout layout = make_layout(settings, cpu);
        for (int kind = 0; kind <= static_cast<int>(KernelKind::inspect); ++kind) {
            const auto asked = static_cast<KernelKind>(kind);
            EXPECT_EQ(kernel_row({asked, FramePart::whole, settings, layout}).kind, asked);
        }
    }
}

// Colours are traced by one of four kernels.
TEST(KernelTable, ColorsByPartTracerAndLayout) {
    Settings settings;
    settings.lanes = settings.packet_w = settings.packet_h = 1;
    const Layout gpu = make_layout(settings, false), cpu = make_layout(settings, true);
    const auto entry = [&](const char* tracer, FramePart part, const Layout& layout) {
        settings.tracer = tracer;
        return std::string(kernel_row({KernelKind::color, part, settings, layout}).entry);
    };
    EXPECT_EQ(entry("iterative", FramePart::whole, gpu), "trace_iterative");
    EXPECT_EQ(entry("wavefront", FramePart::whole, gpu), "trace_wavefront");
    EXPECT_EQ(entry("wavefront", FramePart::closest, gpu), "trace_parts");
    EXPECT_EQ(entry("iterative", FramePart::whole_any_double_leaf, cpu), "trace_iterative");
    settings.tracer = "iterative";
    const auto headers = [&](const Layout& layout) {
        return std::string(kernel_row({KernelKind::color, FramePart::whole, settings, layout}).headers.back());
    };
    EXPECT_EQ(headers(gpu), "tracers/iterative/iterative_single.h") << "one pixel a work-item";
    EXPECT_EQ(headers(cpu), "tracers/iterative/generations.h");
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
        try {
            resolve_packet(settings, gpu);
            ADD_FAILURE() << lanes << " lanes on a GPU";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), Exit::usage);
            EXPECT_NE(std::string(error.what()).find("a GPU computes work-items side by side"), std::string::npos)
                << error.what();
        }
    }
}

}  // namespace
}  // namespace clarity
