#include "tools/check/shapes/touches.hpp"

#include <algorithm>
#include <cmath>

#include "device/cl_errors.hpp"
#include "device/program.hpp"
#include "device/source_writer.hpp"
#include "tools/check/guarded_numbers.hpp"

namespace clarity::check {
namespace {

// Draws points about the box of a part.
class Around {
 public:
    Around(const ShapeSubject& subject, std::mt19937& random) : random_(random), size_(subject.size) {
        for (size_t k = 0; k < 3; ++k) {
            lo_[k] = subject.lo[k];
            hi_[k] = subject.hi[k];
        }
    }
    double share() { return std::uniform_real_distribution<double>(0, 1)(random_); }
    // grown: the box's width and this share of the part's size on either side.
    Vec inside(double grown = 0) {
        Vec p;
        for (size_t k = 0; k < 3; ++k) p[k] = lo_[k] - grown * size_ + (hi_[k] - lo_[k] + 2 * grown * size_) * share();
        return p;
    }
    Vec beside() { return 0.5 * (lo_ + hi_) + size_ * (0.6 + 1.4 * share()) * random_direction(random_); }
    size_t axis() { return std::min<size_t>(static_cast<size_t>(3 * share()), 2); }
    double size() const { return size_; }

 private:
    std::mt19937& random_;
    const double size_;
    Vec lo_{}, hi_{};
};

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

Vec across(const Vec& direction) {
    return normalized(cross(direction, std::fabs(direction[0]) < 0.6 * length(direction) ? Vec{1, 0, 0} : Vec{0, 1, 0}));
}

Vec random_direction(std::mt19937& random) {
    std::normal_distribution<double> normal;
    Vec v;
    do v = {normal(random), normal(random), normal(random)};
    while (dot(v, v) < 1e-6);
    return normalized(v);
}

rt_ray ray_of(const Vec& origin, const Vec& direction, double t_min) {
    rt_ray ray{};
    for (size_t k = 0; k < 3; ++k) {
        ray.origin[k] = static_cast<float>(origin[k]);
        ray.direction[k] = static_cast<float>(direction[k]);
    }
    ray.t_min = static_cast<float>(t_min);
    ray.t_max = INFINITY;
    return ray;
}

std::vector<rt_ray> rays_at(const ShapeSubject& subject, size_t count, std::mt19937& random) {
    Around around(subject, random);
    std::vector<rt_ray> rays;
    for (size_t i = 0; rays.size() < count; ++i) {
        const Vec target = around.inside();
        Vec from = around.beside(), along;
        switch (i % 6) {
            case 0:  // from inside of the box, in any direction
                from = around.inside();
                along = random_direction(random);
                break;
            case 1: {  // along an axis
                const size_t k = around.axis();
                along = {};
                along[k] = around.share() < 0.5 ? 1 : -1;
                from = target - 1.5 * around.size() * along;
                break;
            }
            case 2: {  // one component of the direction is 0
                const size_t k = around.axis();
                along = target - from;
                along[k] = 0;
                from = target - along;
                break;
            }
            case 3:  // past the box, where nothing may be
                along = around.inside(0.25) - from;
                break;
            default:
                along = target - from;
        }
        if (!(length(along) > 0)) continue;
        along = std::exp2(6 * around.share() - 3) * normalized(along);
        rays.push_back(ray_of(from, along, i % 7 == 3 ? -0.5 * around.size() / length(along) : 0));
    }
    return rays;
}

std::vector<Touch> touches_of(ShapeProbe& probe, const ShapeSubject& subject, const std::vector<rt_ray>& rays) {
    std::vector<Touch> touches;
    const auto add = [&](const std::vector<rt_ray>& asked, bool is_second) {
        const std::vector<ProbeHit> hits = probe.hits(subject, asked);
        for (size_t i = 0; i < asked.size(); ++i)
            if (is_hit(asked[i], hits[i])) {
                Touch touch{asked[i], hits[i], point_of(asked[i], hits[i].t)};
                touch.is_second = is_second;
                touches.push_back(touch);
            }
    };
    add(rays, false);
    const double step = neighbour_distance(subject);
    std::vector<rt_ray> behind;
    for (const Touch& touch : touches) {
        behind.push_back(touch.ray);
        behind.back().t_min = static_cast<float>(double(touch.hit.t) + 2 * step / length(to_vec(touch.ray.direction)));
    }
    add(behind, true);

    std::vector<rt_ray> neighbours;
    for (const Touch& touch : touches) {
        const Vec d = to_vec(touch.ray.direction), a = across(d), b = normalized(cross(d, a));
        for (const Vec& aside : {a, -1.0 * a, b, -1.0 * b}) {
            neighbours.push_back(
                ray_of(to_vec(touch.ray.origin) + step * aside, d, double(touch.hit.t) - 10 * step / length(d)));
        }
    }
    const std::vector<ProbeHit> beside = probe.hits(subject, neighbours);
    for (size_t i = 0; i < touches.size(); ++i) {
        Touch& touch = touches[i];
        const double d = length(to_vec(touch.ray.direction));
        Vec points[4];
        bool all = true;
        for (size_t k = 0; k < 4; ++k) {
            const size_t n = 4 * i + k;
            all =
                all && is_hit(neighbours[n], beside[n]) && std::fabs(double(beside[n].t) - double(touch.hit.t)) * d < 8 * step;
            points[k] = point_of(neighbours[n], beside[n].t);
        }
        if (!all) continue;
        const auto bend = [&](size_t k) {
            return std::fabs(double(beside[4 * i + k].t) + double(beside[4 * i + k + 1].t) - 2 * double(touch.hit.t)) * d;
        };
        if (bend(0) > 0.1 * step || bend(2) > 0.1 * step) continue;
        const Vec n = cross(points[0] - points[1], points[2] - points[3]);
        if (!(length(n) > 0)) continue;
        touch.across = normalized(n);
        touch.cosine = -dot(touch.across, to_vec(touch.ray.direction)) / d;
        if (touch.cosine < 0) {
            touch.across = -1.0 * touch.across;
            touch.cosine = -touch.cosine;
        }
        touch.is_smooth = touch.cosine > 0.15;
    }
    return touches;
}

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
