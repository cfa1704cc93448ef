// aov.cpp -- the tracer of AOVs: one property of what the camera rays hit, without shading.
#include "view/settings/aov.hpp"

#include "device/source_writer.hpp"
#include "tracers/tracer.hpp"

namespace clarity {
namespace {

// Defines a number for each AOV: RT_AOV_T, ... One program computes all that need no counters, another one those that do, so
// that changing from one to the next compiles nothing.
void define_aovs(SourceWriter& out, const Settings& settings) {
    unsigned count = 0;
    for (const Aov& aov : aov_table()) {
        out.define_int(kernel_macro(aov), number_of(aov));
        count += aov.tracer && aov.tracer == std::string("aov");
    }
    out.define_int("RT_AOV_COUNT", count);
    out.line("#define RT_AOV");
    if (find_aov(settings.aov).counts_steps) out.line("#define RT_COUNT_STEPS");
}

const KernelRow& kernel(const Settings&, const Layout&) {
    static const KernelRow row = [] {
        KernelRow r;
        r.tracer = "aov";
        r.what = "tracer of AOVs";
        r.file = "tracers/aov/aov.cl";
        r.entry = "trace_aov";
        r.headers = material_headers();
        r.traits = kNearestOnly | kReadsUvs | kFrame;
        r.define = define_aovs;
        return r;
    }();
    return row;
}

}  // namespace

const Tracer& aov_tracer() {
    static const Tracer tracer = [] {
        Tracer t;
        t.id = "aov";
        t.kernel = kernel;
        return t;
    }();
    return tracer;
}

}  // namespace clarity
