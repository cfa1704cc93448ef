// iterative.cpp -- the tracer `iterative`: a work-item traces all generations of its packet, as in the thesis.
#include "tracers/iterative/iterative.hpp"

#include "device/source_writer.hpp"
#include "tracers/tracer.hpp"
#include "view/settings/aov.hpp"

namespace clarity {
namespace {

KernelRow row_of(const std::vector<const char*>& headers, unsigned traits, const std::vector<std::string>& defines = {}) {
    KernelRow row;
    row.tracer = "iterative";
    row.what = "tracer iterative";
    row.file = "tracers/iterative/iterative.cl";
    row.entry = "trace_iterative";
    row.headers = headers;
    row.defines = defines;
    row.traits = traits | kFrame | kCountsRays | kWhitted;
    row.define = define_ray_slots;
    return row;
}

// One pixel a work-item, as only GPUs have it: there rays that do not split need no array.
std::vector<const char*> headers_of_one_pixel() {
    std::vector<const char*> headers = material_headers();
    headers.insert(headers.end(), {"tracers/iterative/ray_queue.h", "shading/shading.h", "tracers/ray_step.h",
                                   "tracers/iterative/iterative_single.h"});
    return headers;
}

const KernelRow& kernel(const Settings& settings, const Layout& layout) {
    static const KernelRow packets = row_of(headers_by_generations(false), kLimitRegisters | kLayers),
                           pixels = row_of(headers_of_one_pixel(), kLimitRegisters | kLayers),
                           numbers = row_of(headers_by_generations(false), 0, {"RT_SHOW_GENERATIONS"});
    if (!find_aov(settings.aov).is_color()) return numbers;
    return layout.max_pixels == 1 && layout.lanes == 1 ? pixels : packets;
}

}  // namespace

std::vector<const char*> headers_by_generations(bool recorded) {
    std::vector<const char*> headers = material_headers();
    headers.emplace_back("tracers/iterative/ray_queue.h");
    if (recorded) headers.insert(headers.end(), {"tracers/inspect/one_lane.h", "tracers/inspect/recorder.h"});
    headers.emplace_back("shading/shading.h");
    if (recorded) headers.emplace_back("tracers/inspect/record_hits.h");
    headers.emplace_back("tracers/iterative/generations.h");
    return headers;
}

void define_ray_slots(SourceWriter& out, const Settings& settings) {
    out.define_int("RT_RAY_SLOTS", static_cast<unsigned>(settings.ray_slots));
}

const Tracer& iterative_tracer() {
    static const Tracer tracer = [] {
        Tracer t;
        t.id = "iterative";
        t.help = "a work-item traces all generations of its packet";
        t.picture = kWhittedPicture;
        t.kernel = kernel;
        t.is_choice = true;
        t.merit = [](const DeviceInfo&, const Scene&) { return 1u; };
        return t;
    }();
    return tracer;
}

}  // namespace clarity
