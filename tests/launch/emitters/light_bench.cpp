#include "launch/emitters/light_bench.hpp"

#include <cmath>
#include <random>

#include "base/angle.hpp"
#include "device/cl_errors.hpp"
#include "launch/device_scene.hpp"
#include "launch/emitters/emitter_table.hpp"
#include "launch/frame_constants.hpp"
#include "launch/view_buffers.hpp"
#include "stand/multi_preparer.hpp"

namespace clarity::test {
namespace {

constexpr unsigned kIn = 4, kOut = 15, kMostChances = 1024;

// Numbers of all samples follow each other field by field.
constexpr const char* kKernel = R"(
RT_INLINE vfloat rt_test_load(const global float *from, uint first)
{
    float values[RT_LANES];
    for (uint l = 0; l < RT_LANES; ++l) values[l] = from[first + l];
    return rt_load(values);
}
RT_INLINE void rt_test_store(global float *to, uint first, vfloat value)
{
    float values[RT_LANES];
    rt_store(value, values);
    for (uint l = 0; l < RT_LANES; ++l) to[first + l] = values[l];
}
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void
try_lights(const constant rt_frame *frame, const uint count, const uint draws, const float x, const float y, const float z,
           const float nx, const float ny, const float nz, const global float *numbers, global float *answers, RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    const uint first = (uint)get_global_id(0) * RT_LANES;
    const vfloat pick = rt_test_load(numbers, first), u1 = rt_test_load(numbers, count + first), u2 = rt_test_load(numbers, 2u * count + first);
    const vmask all = rt_vint(-1);
    const rt_vec at = rt_splat(x, y, z);
    RT_BY_TREE(const rt_vec normal = rt_splat(nx, ny, nz); const vfloat u_tree = rt_test_load(numbers, 3u * count + first);)
    rt_light_sample s;
    if (draws != 0u) {
        s = rt_light_draw(&ctx, frame, at, pick, u1, u2, all RT_TREE_ARG(u_tree) RT_TREE_ARG(normal));
    } else {
        s.towards = rt_warp_cone(u1, u2, rt_vfloat(2.0f));
        s.radiance_over_pdf = rt_splat(0.0f, 0.0f, 0.0f);
        s.distance = RT_INFINITY;
        s.pdf = rt_vfloat(0.0f);
        s.valid = all;
        s.delta = s.light = rt_vint(0);
    }
    rt_rays ray;
    rt_hits hit;
    ray.ox = at.x, ray.oy = at.y, ray.oz = at.z;
    ray.dx = s.towards.x, ray.dy = s.towards.y, ray.dz = s.towards.z;
    ray.t_min = rt_vfloat(0.0f);
    rt_prepare(&ray, RT_ALL_LANES);
    rt_clear_hits(&hit, all);
    hit.t = s.distance;
    rt_trace_any(&ctx, frame, &ray, &hit);
    const vmask occluded = RT_MASK(hit.t < rt_vfloat(0.0f));
    rt_clear_hits(&hit, all);
    rt_trace_closest(&ctx, frame, &ray, &hit);
    const rt_surface surface = rt_resolve(&ctx, &ray, &hit, RT_ALL_LANES);
    vfloat t = rt_select(surface.hit, hit.t, RT_INFINITY), pdf = rt_vfloat(0.0f), other;
    vint light;
    rt_hit_lights(&ctx, frame, &ray, &t, &light);
    const vmask lit = RT_MASK(light >= rt_vint(0)), on = surface.hit & ~lit, off = ~surface.hit & ~lit;
    rt_vec found = rt_emission_of_light(&ctx, &ray, t, light, all RT_TREE_ARG(normal), &pdf);
    const rt_vec of_surface = rt_emission_of_hit(&ctx, &ray, &hit, &surface, on RT_TREE_ARG(normal), &other);
    found = rt_choose(on, of_surface, found);
    pdf = rt_select(on, other, pdf);
    const rt_vec of_sky = rt_sky(&ctx, frame, s.towards, off, &other);
    found = rt_choose(off, of_sky, found);
    pdf = rt_select(off, other, pdf);
    const vint flags = (s.valid & rt_vint(1)) | (s.delta & rt_vint(2)) | (occluded & rt_vint(4));
    const vfloat fields[15] = {s.towards.x, s.towards.y, s.towards.z, s.radiance_over_pdf.x, s.radiance_over_pdf.y, s.radiance_over_pdf.z,
                               s.distance, s.pdf, rt_to_float(flags), rt_as_vfloat(s.light), found.x, found.y, found.z, pdf, t};
    for (uint i = 0; i < 15u; ++i) rt_test_store(answers, i * count + first, fields[i]);
}
#ifdef RT_LIGHT_TREE
/* Of each emitter the probability that it is picked, behind how many there are. */
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void
try_chances(const constant rt_frame *frame, const float x, const float y, const float z, const float nx, const float ny, const float nz,
            global float *answers, RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    const rt_lit_point point = {{x, y, z}, {nx, ny, nz}};
    const uint count = ctx.lighting->emitter_count;
    answers[0] = (float)count;
    for (uint i = 0; i < count; ++i) answers[1u + i] = ctx.emitters[i].kind == RT_EMITTER_TREE ? 0.0f : rt_pick_of(&ctx, ctx.emitters + i, &point);
}
#endif
)";

const KernelRow& kernel_row() {
    static const KernelRow row = [] {
        KernelRow r;
        r.tracer = "rays";
        r.what = "light test";
        r.file = emitter_headers().back();
        r.entry = "try_lights";
        r.headers = {"sampling/math.h", "sampling/warps.h"};
        r.headers.insert(r.headers.end(), material_headers().begin(), material_headers().end());
        r.headers.insert(r.headers.end(), emitter_headers().begin(), emitter_headers().end() - 1);
        r.traits = kPicksLights;
        return r;
    }();
    return row;
}

void put(rt_f32* to, const Point& from) {
    std::copy(from.begin(), from.end(), to);
}

rt_light light_of(rt_u32 kind, const Point& position, float color) {
    rt_light light = whitted_light(kind, position, {color, 0.5f * color, 0.25f * color});
    light.flags = RT_LIGHT_FALLOFF;
    return light;
}

Point unit(const Point& p) {
    return to_floats(normalized(to_vec(p)));
}

// Adds something tiny and dark of each kind, far away, so that all scenes have one kernel: compiling takes most of the time.
Scene with_all_kinds(Scene scene) {
    constexpr float kAway = -50, kSize = 1e-3f;
    Sphere ball;
    ball.center = {0, kAway, 0};
    ball.radius = kSize;
    scene.spheres.push_back(ball);
    Polygon polygon;
    polygon.first_corner = rt_u32(scene.polygon_corners.size() / 3);
    polygon.corner_count = 3;
    scene.polygons.push_back(polygon);
    const Point corners[] = {{0, kAway, 0}, {kSize, kAway, 0}, {0, kAway, kSize}};
    for (const Point& corner : corners) scene.polygon_corners.insert(scene.polygon_corners.end(), corner.begin(), corner.end());
    TriangleMesh mesh;
    mesh.add_triangle(corners[0], corners[1], corners[2]);
    const rt_u32 dark = add_material(scene, diffuse(0, 0, 0)), number = add_mesh(scene, mesh, dark);
    scene.spheres.back().material = scene.polygons.back().material = dark;
    for (const float x : {0.0f, 1.0f}) place(scene, number, {1, 0, 0, x, 0, 1, 0, 0, 0, 0, 1, 0});
    return scene;
}

}  // namespace

struct LightBench::Impl {
    ScenePtr scene;
    View view;
    std::shared_ptr<Device> device;
    std::shared_ptr<const Prepared> prepared;
    std::shared_ptr<TraceProgram> program;
    ViewBuffers buffers;
};

LightBench::LightBench(const Scene& scene, const View& view, int lanes, bool tree) : impl_(std::make_unique<Impl>()) {
    Impl& im = *impl_;
    im.scene = shared_scene(with_all_kinds(scene));
    im.view = view;
    im.device = Workbench::get().shared_device();
    Settings settings =
        make_settings({{"accel", "bvh2"}, {"lanes", std::to_string(lanes)}, {"light_sampling", tree ? "tree" : "table"}});
    settings.optics = {RT_LIGHTS_ALL, RT_LOBES_ALL & ~RT_LOBE_COAT};  // varnish above a lamp needs the headers of surfaces
    Progress progress;
    const rt_plugin& plugin = *Workbench::get().plugins().accel("bvh2");
    auto accel = std::make_shared<AccelData>(build_accel(*im.scene, plugin, default_parameters(plugin), progress));
    im.prepared = prepare_queries(*im.device, im.scene, std::move(accel), settings, progress);
    KernelSource source = kernel_for(*im.prepared, kernel_row());
    source.text += kKernel;
    source.declarations = kKernel;
    static ProgramCache programs(im.device);
    im.program = programs.get(source);
}

LightBench::~LightBench() = default;

std::vector<LightDraw> LightBench::run(const Point& at, const Numbers& numbers, const Vec& normal, bool draws) {
    Impl& im = *impl_;
    return wrap_cl_errors(*im.device, "drawing lights", [&] {
        const unsigned lanes = im.prepared->layout.lanes;
        const size_t count = (numbers.size() + lanes - 1) / lanes * lanes;
        std::vector<float> in(kIn * count, 0.5f), out(kOut * count);
        for (size_t i = 0; i < numbers.size(); ++i)
            for (unsigned k = 0; k < kIn; ++k)
                in[k * count + i] = k < 3 ? numbers[i][k] : numbers[i][0] * 1024 - std::floor(numbers[i][0] * 1024);
        Queue& queue = im.device->queue();
        Settings settings = im.prepared->settings;
        im.buffers.write(queue, *im.scene, *im.prepared->on_device,
                         {make_frame(im.view, settings, im.prepared->layout, *im.prepared->accel, 0)}, im.view);
        im.buffers.write_emitters(queue, *im.scene, im.prepared->accel, im.view, settings);
        const cl::Context& context = im.device->context();
        const cl::Buffer from(context, CL_MEM_READ_ONLY, in.size() * sizeof(float)),
            to(context, CL_MEM_READ_WRITE, out.size() * sizeof(float));
        queue.enqueueWriteBuffer(from, CL_TRUE, 0, in.size() * sizeof(float), in.data());
        KernelArguments kernel = im.program->kernel("try_lights");
        kernel.set("count", cl_uint(count)).set("draws", cl_uint(draws)).set("x", at[0]).set("y", at[1]).set("z", at[2]);
        kernel.set("nx", float(normal[0])).set("ny", float(normal[1])).set("nz", float(normal[2]));
        kernel.set("numbers", from).set("answers", to);
        im.buffers.bind(*im.prepared->on_device, kernel);
        queue.enqueueNDRangeKernel(kernel.kernel(), cl::NullRange, cl::NDRange(count / lanes), cl::NDRange(1));
        queue.enqueueReadBuffer(to, CL_TRUE, 0, out.size() * sizeof(float), out.data());
        std::vector<LightDraw> results(numbers.size());
        for (size_t i = 0; i < results.size(); ++i) {
            const auto field = [&](unsigned f) { return out[f * count + i]; };
            LightDraw& r = results[i];
            const auto flags = static_cast<unsigned>(field(8));
            r = {{field(0), field(1), field(2)},
                 {field(3), field(4), field(5)},
                 field(6),
                 field(7),
                 (flags & 1) != 0,
                 (flags & 2) != 0,
                 (flags & 4) != 0,
                 0,
                 {field(10), field(11), field(12)},
                 field(13),
                 field(14)};
            const float number = field(9);
            std::memcpy(&r.number, &number, sizeof number);
        }
        return results;
    });
}

std::vector<LightDraw> LightBench::draw(const Point& at, const Numbers& numbers, const Vec& normal) {
    return run(at, numbers, normal, true);
}

std::vector<LightDraw> LightBench::find(const Point& at, const Numbers& numbers, const Vec& normal) {
    return run(at, numbers, normal, false);
}

std::vector<float> LightBench::chances(const Point& at, const Vec& normal) {
    Impl& im = *impl_;
    draw(at, even_numbers(8, 1), normal);  // uploads the scene
    return wrap_cl_errors(*im.device, "asking for chances", [&] {
        std::vector<float> out(1 + kMostChances);
        const cl::Buffer to(im.device->context(), CL_MEM_READ_WRITE, out.size() * sizeof(float));
        KernelArguments kernel = im.program->kernel("try_chances");
        kernel.set("x", at[0]).set("y", at[1]).set("z", at[2]).set("answers", to);
        kernel.set("nx", float(normal[0])).set("ny", float(normal[1])).set("nz", float(normal[2]));
        im.buffers.bind(*im.prepared->on_device, kernel);
        Queue& queue = im.device->queue();
        queue.enqueueNDRangeKernel(kernel.kernel(), cl::NullRange, cl::NDRange(1), cl::NDRange(1));
        queue.enqueueReadBuffer(to, CL_TRUE, 0, out.size() * sizeof(float), out.data());
        return std::vector<float>(out.begin() + 1, out.begin() + 1 + std::ptrdiff_t(out[0]));
    });
}

double LightBench::irradiance(const Point& at, const Vec& normal, const Numbers& numbers, double* error) {
    double sum = 0, squares = 0;
    for (const LightDraw& draw : run(at, numbers, normal, true)) {
        if (!draw.valid || draw.occluded) continue;
        const double brought = draw.light[0] * std::max(0.0, dot(normal, to_vec(draw.towards)));
        sum += brought;
        squares += brought * brought;
    }
    const double count = double(numbers.size()), mean = sum / count;
    if (error) *error = std::sqrt(std::max(0.0, squares / count - mean * mean) / count);
    return mean;
}

double LightBench::irradiance_by_rays(const Point& at, const Vec& normal, const Numbers& numbers) {
    double sum = 0;
    for (const LightDraw& ray : run(at, numbers, normal, false))
        sum += ray.found[0] * std::max(0.0, dot(normal, to_vec(ray.towards)));
    return sum * 4 * kPi / double(numbers.size());
}

Numbers even_numbers(size_t count, unsigned seed) {
    // 1 / g, 1 / g^2, 1 / g^3 of the root g of g^4 = g + 1.
    constexpr std::array<double, 3> kSteps = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    Numbers numbers(count);
    for (size_t i = 0; i < count; ++i)
        for (int k = 0; k < 3; ++k) {
            const double x = 0.37 * (k + 1) * (seed + 1) + kSteps[k] * double(i + 1);
            numbers[i][k] = std::min(static_cast<float>(x - std::floor(x)), 0x0.ffffffp0f);
        }
    return numbers;
}

Numbers random_numbers(size_t count, unsigned seed) {
    std::mt19937 generator(seed);
    Numbers numbers(count);
    for (auto& three : numbers)
        for (float& number : three) number = static_cast<float>(generator() >> 8) * 0x1p-24f;
    return numbers;
}

Scene empty_scene() {
    Scene scene;
    scene.materials.push_back({"default", diffuse(1, 1, 1)});
    return scene;
}

View dark_view() {
    View view = view_from({0, 0, 5}, {0, 0, 0}, 45);
    view.background = view.ambient = {0, 0, 0};
    return view;
}

rt_light rect_light(const Point& center, const Point& u, const Point& v, float radiance) {
    rt_light light = light_of(RT_LIGHT_RECT, center, radiance);
    put(light.u, u);
    put(light.v, v);
    const Vec n = cross(to_vec(u), to_vec(v));
    put(light.normal, to_floats(normalized(n)));
    light.area = static_cast<float>(4 * length(n));
    return light;
}

rt_light disc_light(const Point& center, const Point& normal, float radius, float radiance) {
    rt_light light = light_of(RT_LIGHT_DISC, center, radiance);
    put(light.normal, unit(normal));
    light.radius = radius;
    light.area = float(kPi) * radius * radius;
    return light;
}

rt_light sphere_light(const Point& center, float radius, float radiance) {
    rt_light light = light_of(RT_LIGHT_SPHERE, center, radiance);
    light.radius = radius;
    light.area = 4 * float(kPi) * radius * radius;
    return light;
}

rt_light sun_light(const Point& towards, double full_angle_deg, float irradiance) {
    rt_light light = light_of(RT_LIGHT_SUN, unit(towards), irradiance);
    light.cos_outer = static_cast<float>(std::cos(full_angle_deg * kPi / 360));
    light.radius = static_cast<float>(std::sin(full_angle_deg * kPi / 360));
    return light;
}

rt_light far_light(const Point& towards, float irradiance) {
    return light_of(RT_LIGHT_DIRECTIONAL, unit(towards), irradiance);
}

rt_light point_light(const Point& at, float intensity) {
    return light_of(RT_LIGHT_POINT, at, intensity);
}

rt_light spot_light(const Point& at, const Point& axis, float intensity, double inner_deg, double outer_deg) {
    rt_light light = light_of(RT_LIGHT_SPOT, at, intensity);
    put(light.normal, unit(axis));
    light.cos_inner = static_cast<float>(std::cos(inner_deg * kPi / 180));
    light.cos_outer = static_cast<float>(std::cos(outer_deg * kPi / 180));
    return light;
}

}  // namespace clarity::test
