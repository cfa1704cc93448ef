#include "tools/check/surfaces/surface_probe.hpp"

#include <algorithm>
#include <cstdio>
#include <set>

#include "device/cl_errors.hpp"
#include "device/program.hpp"
#include "device/set_arguments.hpp"
#include "device/source_writer.hpp"
#include "tools/check/guarded_numbers.hpp"

namespace clarity::check {
namespace {

constexpr unsigned kShare = 64;  // queries that a work-item takes

std::string number_text(double x) {
    char text[32];
    std::snprintf(text, sizeof text, " %.9g", x);
    return text;
}

std::string source_of(const rt_plugin& plugin, const Device& device) {
    SourceWriter out;
    out.define_int("RT_LANES", 1);
    out.define_int("RT_CPU", device.info().traces_packets());
    for (const char* name : {"rt_shared.h", "rt_types.h", "lanes/lanes.h", "shading/surface_draw.h"}) out.include(name);
    out.include(plugin, rt_surface_of(&plugin)->kernels);
    const std::string id = plugin.id;
    out.line("#define RT_PROBE_EVAL " + id + "_eval\n#define RT_PROBE_PDF " + id + "_pdf\n#define RT_PROBE_SAMPLE " + id +
             "_sample");
    out.define_int("RT_PROBE_SHARE", kShare);
    out.include("shading/surface_probe.cl");
    return out.text();
}

}  // namespace

SurfaceSubject surface_subject(const rt_plugin& plugin, const std::array<float, 3>& color,
                               const std::vector<std::array<double, 3>>& values) {
    const rt_surface& surface = *rt_surface_of(&plugin);
    SurfaceSubject subject;
    subject.color = color;
    subject.what = "`model " + std::string(plugin.id) + "  color";
    for (const float c : color) subject.what += number_text(c);
    std::vector<float> numbers;
    for (rt_u32 i = 0; i < surface.key_count; ++i) {
        subject.what += "  " + std::string(surface.keys[i].name);
        for (size_t k = 0; k < (surface.keys[i].kind == RT_KEY_COLOR ? 3 : 1); ++k) {
            numbers.push_back(float(values[i][k]));
            subject.what += number_text(double(numbers.back()));
        }
    }
    subject.what += "`";
    subject.numbers = guarded_numbers(numbers.data(), numbers.size(), "numbers of the surface");
    return subject;
}

std::vector<std::array<double, 3>> surface_defaults(const rt_plugin& plugin) {
    const rt_surface& surface = *rt_surface_of(&plugin);
    std::vector<std::array<double, 3>> values(surface.key_count);
    for (rt_u32 i = 0; i < surface.key_count; ++i) std::copy_n(surface.keys[i].def, 3, values[i].begin());
    return values;
}

std::vector<SurfaceSubject> surface_subjects(const rt_plugin& plugin, const std::array<float, 3>& color) {
    const rt_surface& surface = *rt_surface_of(&plugin);
    const auto usual = surface_defaults(plugin);
    auto least = usual, greatest = usual;
    for (size_t i = 0; i < usual.size(); ++i) least[i].fill(surface.keys[i].min), greatest[i].fill(surface.keys[i].max);
    std::vector<std::vector<std::array<double, 3>>> all = {usual, least, greatest};
    for (size_t i = 0; i < usual.size(); ++i)
        for (const auto& end : {least, greatest}) {
            all.push_back(usual);
            all.back()[i] = end[i];
        }
    std::vector<SurfaceSubject> subjects;
    std::set<std::string> known;
    for (const auto& values : all) {
        SurfaceSubject subject = surface_subject(plugin, color, values);
        if (known.insert(subject.what).second) subjects.push_back(std::move(subject));
    }
    return subjects;
}

SurfaceProbe::SurfaceProbe(const rt_plugin& plugin, std::shared_ptr<Device> device) : device_(std::move(device)) {
    const BuildResult built = build_program(*device_, source_of(plugin, *device_), "-cl-std=CL1.2",
                                            std::string("surface ") + plugin.id + " by itself");
    kernel_ = wrap_cl_errors(*device_, "making kernels", [&] { return cl::Kernel(built.program, "probe_model"); });
}

std::vector<SurfaceAnswer> SurfaceProbe::ask(const SurfaceSubject& subject, const std::vector<SurfaceQuery>& queries) {
    std::vector<SurfaceAnswer> answers(queries.size());
    if (queries.empty()) return answers;
    wrap_cl_errors(*device_, "calling the surface's kernels", [&] {
        const size_t in_bytes = queries.size() * sizeof(SurfaceQuery), out_bytes = answers.size() * sizeof(SurfaceAnswer);
        const cl::Buffer numbers = guarded_buffer(*device_, *subject.numbers);
        const cl::Buffer from(device_->context(), CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, in_bytes,
                              const_cast<SurfaceQuery*>(queries.data()));
        const cl::Buffer to(device_->context(), CL_MEM_READ_WRITE, out_bytes);
        set_arguments(kernel_, numbers, from, to, static_cast<cl_uint>(queries.size()), subject.color[0], subject.color[1],
                      subject.color[2]);
        // One size of work-groups: PoCL compiles a kernel anew for each.
        device_->queue().enqueueNDRangeKernel(kernel_, cl::NullRange, cl::NDRange((queries.size() + kShare - 1) / kShare),
                                              cl::NDRange(1));
        device_->queue().enqueueReadBuffer(to, CL_TRUE, 0, out_bytes, answers.data());
        return 0;
    });
    return answers;
}

}  // namespace clarity::check
