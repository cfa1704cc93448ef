// path.cpp -- the tracer `path`: a path of light at a time in each lane; a lane whose path has ended takes the next pixel.
#include "tracers/path/path.hpp"

#include "launch/emitters/emitter_table.hpp"
#include "tracers/tracer.hpp"
#include "view/settings/aov.hpp"

namespace clarity {
namespace {

KernelRow row_of(const std::vector<std::string>& defines, unsigned more_traits = 0) {
    KernelRow r;
    r.tracer = "path";
    r.what = "tracer path";
    r.file = "tracers/path/path.cl";
    r.entry = "trace_path";
    r.headers = path_headers();
    r.defines = defines;
    r.traits = kLimitRegistersAlways | kFrame | kCountsRays | kPicksLights | kSumsSamples | more_traits;
    return r;
}

const KernelRow& kernel(const Settings& settings, const Layout&) {
    static const KernelRow light = row_of({}), shares = row_of({"RT_SHOW_MIS"}), guided = row_of({"RT_GUIDES"}, kGuides);
    if (settings.aov == "mis") return shares;
    return find_aov(settings.aov).is_color() && (denoises(settings) || settings.optics.guides != 0) ? guided : light;
}

}  // namespace

std::vector<const char*> path_headers(const std::vector<const char*>& recorder) {
    std::vector<const char*> headers = {"sampling/hash.h", "sampling/sobol.h", "sampling/dimensions.h", "sampling/math.h",
                                        "sampling/warps.h"};
    const auto add = [&](const std::vector<const char*>& more) { headers.insert(headers.end(), more.begin(), more.end()); };
    add(material_headers());
    add(surface_headers());
    add(emitter_headers());
    add({"tracers/path/sum.h", "tracers/path/camera_rays.h"});
    add(recorder);
    add({"tracers/path/state.h", "tracers/path/guides.h", "shading/surface_lanes.h", "tracers/path/scatter.h"});
    return headers;
}

const Tracer& path_tracer() {
    static const Tracer tracer = [] {
        Tracer t;
        t.id = "path";
        t.help = "paths of light: lamps with a size, light from surface to surface; depth counts events of scattering";
        t.is_choice = true;
        t.picture = kPathPicture;
        t.kernel = kernel;
        return t;
    }();
    return tracer;
}

}  // namespace clarity
