#include "check/shapes/shape_probe.hpp"
#include "check/guarded_numbers.hpp"

#include <algorithm>
#include <cmath>

#include "device/cl_errors.hpp"
#include "device/program.hpp"
#include "render/kernels/source_writer.hpp"

namespace clarity::check {
namespace {

// As build_scene.cpp: a point's height above a surface has about 16 roundings of numbers of the shape's size.
constexpr float kErrorOfSize = 16 * 0x1p-24f;

std::string source_of(const rt_plugin& plugin, const Device& device, const Variant& variant) {
    SourceWriter out;
    out.define_int("RT_LANES", static_cast<unsigned>(variant.lanes));
    out.define_int("RT_CPU", device.info().traces_packets());
    out.define_uint("RT_KERNEL_CONTRACT", plugin.primitive->kernel_contract);
    if (variant.portable) out.line("#define RT_PORTABLE");
    for (const char* name : {"rt_shared.h", "rt_types.h", "lanes/lanes.h"}) out.include(name);
    if (!device.info().traces_packets()) out.include("lanes/subgroup.h");
    for (const char* name : {"lanes/rays.h", "lanes/vec.h", "primitives/shape.h", "primitives/shape_single_ray.h"})
        out.include(name);
    out.include(plugin, plugin.primitive->kernels);
    const std::string id = plugin.id;
    const bool single = plugin.primitive->flags & RT_SHAPE_SINGLE_RAY;
    out.line("#line 1 \"generated calls\"");
    out.line(
        "RT_NOINLINE vfloat probe_hit(const global float *numbers, const global float *more, const rt_shape_rays *ray, uint "
        "bits, "
        "vfloat *u, vfloat *v)\n{\n" +
        (single ? "    RT_SHAPE_HIT_EACH(" + id + "_hit)" : "    return " + id + "_hit(numbers, more, ray, u, v);") + "\n}");
    out.line(
        "RT_NOINLINE void probe_surface(const global float *numbers, const global float *more, rt_vec at, vfloat u, vfloat v, "
        "uint bits, rt_shape_surface *s)\n{\n" +
        (single ? "    RT_SHAPE_SURFACE_EACH(" + id + "_surface)" : "    " + id + "_surface(numbers, more, at, u, v, s);") +
        "\n}");
    out.include("primitives/shape_probe.cl");
    return out.text();
}

}  // namespace

std::vector<ShapeSubject> subjects_of(const rt_plugin& plugin, const ShapeTrial& trial, size_t most) {
    std::vector<ShapeSubject> subjects;
    const size_t count = trial.scene.shape_parts.size(), taken = std::min(count, most);
    for (size_t i = 0; i < taken; ++i) {
        const size_t at = taken > 1 ? i * (count - 1) / (taken - 1) : 0;
        const ShapePart& part = trial.scene.shape_parts[at];
        ShapeSubject subject;
        subject.what = "`" + trial.values.statement(plugin) + "`";
        if (count > 1) subject.what += ", part " + std::to_string(at + 1) + " of " + std::to_string(count);
        subject.lo = part.min;
        subject.hi = part.max;
        subject.size = std::hypot(part.max[0] - part.min[0], part.max[1] - part.min[1], part.max[2] - part.min[2]);
        for (size_t k = 0; k < 3; ++k)
            subject.coordinate = std::max({subject.coordinate, std::fabs(part.min[k]), std::fabs(part.max[k])});
        subject.error = kErrorOfSize * subject.size;
        subject.numbers = guarded_numbers(part.numbers.data(), part.numbers.size(), "numbers of the shape");
        subject.more =
            guarded_numbers(trial.scene.shape_numbers.data() + part.first_more, part.more_count, "`more` of the shape");
        subjects.push_back(std::move(subject));
    }
    return subjects;
}

ShapeProbe::ShapeProbe(const rt_plugin& plugin, std::shared_ptr<Device> device, const Variant& variant)
    : device_(std::move(device)), lanes_(static_cast<size_t>(variant.lanes)) {
    const BuildResult built = build_program(*device_, source_of(plugin, *device_, variant), "-cl-std=CL1.2",
                                            std::string("shape ") + plugin.id + " with " + variant.text());
    wrap_cl_errors(*device_, "making kernels", [&] {
        hits_ = cl::Kernel(built.program, "probe_hits");
        surfaces_ = cl::Kernel(built.program, "probe_surfaces");
        return 0;
    });
}

void ShapeProbe::run(cl::Kernel& kernel, const ShapeSubject& subject, const void* in, size_t in_bytes, void* out,
                     size_t out_bytes, size_t count, const float* error) {
    if (count == 0) return;
    wrap_cl_errors(*device_, "calling the shape's kernels", [&] {
        const cl::Buffer numbers = guarded_buffer(*device_, *subject.numbers), more = guarded_buffer(*device_, *subject.more);
        const cl::Buffer from(device_->context(), CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, in_bytes, const_cast<void*>(in));
        const cl::Buffer to(device_->context(), CL_MEM_READ_WRITE, out_bytes);
        kernel.setArg(0, numbers);
        kernel.setArg(1, more);
        kernel.setArg(2, from);
        kernel.setArg(3, to);
        kernel.setArg(4, static_cast<cl_uint>(count));
        if (error) kernel.setArg(5, *error);
        // One size of work-groups: PoCL compiles a kernel anew for each.
        device_->queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange((count + lanes_ - 1) / lanes_),
                                              cl::NDRange(1));
        device_->queue().enqueueReadBuffer(to, CL_TRUE, 0, out_bytes, out);
        return 0;
    });
}

std::vector<ProbeHit> ShapeProbe::hits(const ShapeSubject& subject, const std::vector<rt_ray>& rays) {
    std::vector<ProbeHit> answers(rays.size());
    run(hits_, subject, rays.data(), rays.size() * sizeof(rt_ray), answers.data(), answers.size() * sizeof(ProbeHit),
        rays.size(), nullptr);
    return answers;
}

std::vector<ProbeSurface> ShapeProbe::surfaces(const ShapeSubject& subject, const std::vector<ProbePoint>& points) {
    std::vector<ProbeSurface> answers(points.size());
    run(surfaces_, subject, points.data(), points.size() * sizeof(ProbePoint), answers.data(),
        answers.size() * sizeof(ProbeSurface), points.size(), &subject.error);
    return answers;
}

}  // namespace clarity::check
