#include "tools/trial/trial_worker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "base/angle.hpp"
#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "base/problem.hpp"
#include "device/cl_errors.hpp"
#include "device/device.hpp"
#include "plugin/registry.hpp"
#include "scene/material_keys.hpp"
#include "scene/scene.hpp"
#include "scene/surface_models.hpp"
#include "scene/tangents.hpp"
#include "stand/multi_preparer.hpp"
#include "stand/triangle_mesh.hpp"
#include "tracers/smoke.hpp"
#include "trial/trial_job.hpp"
#include "worker/child.hpp"
#include "worker/guarded_memory.hpp"

namespace clarity {
namespace {

// What the worker that tries kernels does with them.

// Tells what kernels do next, in the past tense ("they traced a frame ..."), and how many seconds of processor time of all
// threads it may take.
using TrialSteps = std::function<void(const std::string& step, double limit_s)>;

// The small scene on which kernels are tried. It is made by formula.
enum : rt_u32 { kMatt, kGlass, kMirror, kTextured };

// A sphere with bumps. The last vertices of a row lie where its first ones do, with other coordinates of textures.
TriangleMesh bumps() {
    constexpr rt_u32 kRows = 16, kColumns = 32;
    constexpr auto pi = static_cast<float>(kPi);
    TriangleMesh mesh;
    mesh.add_grid({kRows, kColumns, {{{0, 2, 1}, {1, 2, 3}}}}, [&](rt_u32 row, rt_u32 column) {
        const float v = float(row) / kRows, u = float(column) / kColumns;
        const float up = v * pi, round = u * 2 * pi, radius = 1 + 0.1f * std::sin(5 * up) * std::cos(4 * round);
        const Vec direction = to_vec(Point{std::sin(up) * std::cos(round), std::cos(up), std::sin(up) * std::sin(round)});
        mesh.add_vertex(double(radius) * direction, direction, u, v);
    });
    return mesh;
}

TriangleMesh trial_floor() {
    TriangleMesh mesh;
    mesh.add_grid({1, 1, {{{0, 1, 2}, {2, 1, 3}}}}, [&](rt_u32 row, rt_u32 column) {
        const double x = row ? 6 : -6, z = column ? 6 : -6;
        mesh.add_vertex({x, -1.2f, z}, {0, 1, 0}, x, z);
    });
    return mesh;
}

void add_materials(Scene& scene, bool textures) {
    scene.materials.assign(4, Material{"", default_material()});
    scene.materials[kGlass].values.refract = 0.8f;
    scene.materials[kMirror].values.reflect = 0.7f;
    if (!textures) return;
    scene.materials[kTextured].values.texture = 0;
    scene.textures.push_back({0, 2, 2, 0, 0, 0, 0});
    for (const uint32_t texel : {0xFF2040C0u, 0xFFE0E0E0u, 0xFF40C020u, 0xFF808080u}) scene.texels.push_back(texel);
}

// Maps, smaller pictures, second coordinates and tangents as the features say, which the textured material has.
void add_maps(Scene& scene, const SceneFeatures& features) {
    if (features.mips) {
        scene.texels.push_back(0xFF909090u);
        scene.textures[0].levels = 1;
    }
    if (features.uvs2) scene.uvs2 = scene.uvs;
    const auto add = [&](rt_u32 use) {
        scene.materials[kTextured].maps[use] = static_cast<rt_u32>(scene.maps.size());
        scene.maps.push_back({{1, 0, 0, 0, 1, 0.5f}, 0, features.uvs2 ? 1u : 0u, 0.5f, 0});
    };
    if (features.maps) add(RT_MAP_OCCLUSION);
    if (features.tangents) add(RT_MAP_NORMAL);
    make_tangents(scene);
}

// Models that plugins bring, on every other triangle.
void add_surfaces(Scene& scene, rt_u32 lobes) {
    std::vector<rt_u32> own;
    for (const SurfaceModel& model : surface_models()) {
        if (!(lobes & lobe_of_surface(model.number))) continue;
        own.push_back(static_cast<rt_u32>(scene.materials.size()));
        scene.materials.push_back({"", default_material()});
        set_material_value(scene.materials.back().values, material_key("model"), {static_cast<float>(model.number), 0, 0});
    }
    if (own.empty()) return;
    std::vector<rt_u32> materials(scene.triangle_materials.begin(), scene.triangle_materials.end());
    for (size_t t = 0; t < materials.size(); t += 2) materials[t] = own[t / 2 % own.size()];
    scene.triangle_materials = SharedArray<rt_u32>(std::move(materials));
}

// In rows above the other objects.
void add_shapes(Scene& scene, const std::vector<TrialShape>& shapes) {
    size_t number = 0;
    for (const TrialShape& shape : shapes)
        for (rt_u32 kind = 0; kind < scene.shape_kinds.size(); ++kind) {
            if (scene.shape_kinds[kind].id != shape.id) continue;
            const size_t column = number % 5, row = number / 5;
            add_shape(scene, shape, kind, std::array{kMatt, kGlass, kMirror}[number % 3],
                      {-2.4f + 1.2f * static_cast<float>(column), 1.5f + 0.9f * static_cast<float>(row), 0.3f}, 0.45f);
            ++number;
        }
}

// About 1000 triangles, an object of glass and a mirror, one light and a camera. It has instances, spheres, polygons, planes,
// normals, texture coordinates and textures as the features say, so that its kernels are those of any scene with them. kinds:
// those of the shapes, which are added, too.
Scene trial_scene(const SceneFeatures& features, const std::vector<ShapeKind>& kinds, const std::vector<TrialShape>& shapes) {
    Scene scene;
    add_materials(scene, features.textures);
    add_mesh(scene, bumps(), kGlass, "bumps");
    add_mesh(scene, trial_floor(), kTextured, "floor");
    add_surfaces(scene, features.optics.lobes);
    if (!features.normals) scene.normals = {};
    if (!features.uvs && !features.textures) scene.uvs = {};
    if (features.textures) add_maps(scene, features);
    if (features.optics.cutouts) {
        scene.materials[kMatt].values.alpha = RT_ALPHA_BLEND;
        scene.materials[kMatt].values.opacity = 0.5f;
        scene.materials[kTextured].values.alpha = RT_ALPHA_MASK;
    }
    if (features.colors)  // dim towards the last vertex
        for (rt_u32 v = 0; v < scene.vertex_count(); ++v)
            for (const float c : {1.0f, 1.0f - float(v) / scene.vertex_count(), 0.5f, 1.0f}) scene.colors.push_back(c);
    place(scene, 0);
    place(scene, 1);
    if (features.instances) {  // turned, stretched and mirrored
        place(scene, 0, {0.6f, 0, 0.8f, -2.5f, 0, 0.7f, 0, 0, -0.8f, 0, 0.6f, -1}, kMirror);
        place(scene, 0, {-0.8f, 0, 0, 2.4f, 0, 1.1f, 0, 0.2f, 0, 0, 0.5f, -1}, kMatt);
    }
    if (features.spheres) {
        scene.spheres.push_back({{-1.2f, -0.7f, 1.5f}, 0.5f, kMirror});
        scene.spheres.push_back({{1.3f, -0.8f, 1.4f}, 0.4f, kGlass});
    }
    if (features.polygons) {
        for (const float corner :
             {-3.0f, -1.0f, -3.0f, 0.0f, 0.5f, -3.0f, 3.0f, -1.0f, -3.0f, 3.0f, 3.0f, -3.0f, -3.0f, 3.0f, -3.0f})  // not convex
            scene.polygon_corners.push_back(corner);
        scene.polygons.push_back({0, 5, kMatt});
    }
    if (features.planes) scene.planes.push_back({{0, 1, 0}, -1.5f, kMatt});
    scene.shape_kinds = kinds;
    add_shapes(scene, shapes);
    Light light;
    light.values = whitted_light(RT_LIGHT_POINT, {4, 6, 5}, {40, 40, 40});
    scene.lights.push_back(light);
    Camera camera;
    camera.eye = {0, 1, 6};
    scene.cameras.push_back(camera);
    return scene;
}

constexpr double kBuildLimit_s = 30;  // of processor time
constexpr int kWidth = 64, kHeight = 48, kDepth = 5;

class TrialProgress : public Progress {
 public:
    explicit TrialProgress(const TrialSteps& say_step) : say_step_(say_step) {}
    void stage(const std::string& text) override { say_step_(text, kBuildLimit_s); }

 private:
    const TrialSteps& say_step_;
};

// A copy of a structure, with its arrays between guard pages. Kernels on a CPU read them in place. They are compiled with what
// the user's structure defines: a stack that a thread has no room for crashes here.
std::shared_ptr<const AccelData> guarded(const AccelData& built, const std::map<std::string, rt_u32>& defines,
                                         std::list<GuardedBytes>& memory) {
    const rt_accel& accel = *built.layout->accel;
    rt_u32 slot = 0;
    auto copied = std::make_shared<AccelData>(copy_of(built, [&](const AlignedBytes& from) {
        const std::string name = slot < accel.slot_count ? std::string("the slot ") + accel.slots[slot].name : "the leaves";
        ++slot;
        GuardedBytes& copy = memory.emplace_back(from.bytes(), name);
        if (from.bytes() > 0) std::memcpy(copy.data(), from.data(), from.bytes());
        copy.make_read_only();
        return AlignedBytes::borrow(copy.data(), copy.bytes());
    }));
    for (const auto& [name, value] : defines) {
        rt_u32& here = copied->defines[name];
        here = std::max(here, value);
    }
    return copied;
}

// Between guard pages, which kernels on a CPU see.
cl::Buffer guarded_buffer(Device& device, std::list<GuardedBytes>& memory, const char* name, size_t bytes) {
    GuardedBytes& block = memory.emplace_back(bytes, name);
    return {device.context(), CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes, block.data()};
}

// Runs kernels as the job says. Returns why there is no trial; nothing: the kernels have passed. Throws Error if they have
// not. job: of other kernels than the film's; its `settings` are those of the program that is tried.
Problem try_on_small_scene(const TrialJob& job, const PluginRegistry& plugins, const std::shared_ptr<Device>& device,
                           const TrialSteps& say_step) {
    std::vector<ShapeKind> kinds;
    for (const TrialShape& shape : job.shapes) {
        const auto same = [&](const ShapeKind& kind) { return kind.id == shape.id; };
        if (std::any_of(kinds.begin(), kinds.end(), same)) continue;
        kinds.push_back({shape.id, plugins.primitive(shape.id)});
        if (!kinds.back().plugin) return "there is no plugin for shapes `" + shape.id + "`";
    }
    const auto scene = std::make_shared<const Scene>(trial_scene(job.features, kinds, job.shapes));
    Settings settings = job.settings;
    settings.debug = true;  // stacks are checked
    settings.optics = job.features.optics;
    settings.width = kWidth;
    settings.height = kHeight;
    settings.crop = {};
    settings.depth = std::min(settings.depth, kDepth);
    settings.spp = 1;
    settings.shutter = 0;
    TrialProgress progress(say_step);
    MultiPreparer preparer(plugins, {device});
    std::list<GuardedBytes> memory;  // outlives all that uses the structure
    const auto accel = guarded(*preparer.build(scene, settings, progress), job.defines, memory);
    const auto prepared = prepare_queries(*device, scene, accel, settings, progress);
    const Smoke smoke{device, *prepared, make_view(*scene, float(kWidth) / float(kHeight)), say_step};
    const Tracer& tracer = find_tracer(job.kernels);
    if (tracer.smoke)
        tracer.smoke(smoke);
    else
        smoke_frames(tracer, smoke);
    return {};
}

// The same for the kernels of the film.
Problem try_film_kernels(const std::shared_ptr<Device>& device, const TrialSteps& say_step) {
    say_step("compiling kernels", kCompileLimit_s);
    const double begin_ms = processor_ms();
    std::optional<FilmKernels> kernels;
    try {
        kernels.emplace(device);
    } catch (const Error& e) {  // the process that asked for the trial says so itself
        return e.what();
    }
    FilmKernels& film = *kernels;
    const double limit_s = kRunLimit_s + 3e-3 * (processor_ms() - begin_ms);
    constexpr unsigned kPixels = kWidth * kHeight, kLayers = 3, kRows = 6;
    std::list<GuardedBytes> memory;
    return wrap_cl_errors(*device, "trying the film", [&] {
        const auto buffer = [&](const char* name, size_t bytes) { return guarded_buffer(*device, memory, name, bytes); };
        const cl::Buffer sums = buffer("the film", kPixels * 4 * sizeof(float)), display = buffer("the display", kPixels * 4),
                         layers = buffer("the layers", kLayers * kPixels * 4 * sizeof(float)),
                         counters = buffer("the counters", kPixels * 4 * sizeof(uint64_t));
        const std::vector<rt_u32> rows{0, 2, kRows - 1};
        const GroupRows some{kWidth, kHeight, kHeight / kRows, rows};
        std::vector<uint8_t> rgba(kPixels * 4);
        std::vector<KernelTime> times(1);
        const auto run = [&](const char* what, const auto& enqueue) {
            say_step(std::string("they ") + what, limit_s);
            enqueue();
            device->queue().finish();
        };
        run("added layers to the film", [&] { film.add_layers(sums, layers, kLayers, true, some); });
        for (const std::string& tone : tone_names()) {
            Settings settings;
            settings.tone = tone;
            run("mapped tones", [&] { film.map_tones(sums, display, kPixels, settings); });
            run("mapped tones of some rows", [&] {
                film.begin_rows(sums, some, settings, rgba.data());
                film.end_rows(times);
            });
        }
        for (const auto width : {FilmKernels::CounterWidth::bits32, FilmKernels::CounterWidth::bits64})
            run("added up counters", [&] {
                film.begin_sum(counters, kPixels, width);
                film.end_sum(times.front());
            });
        return Problem();
    });
}

// Mesa's llvmpipe compiles a kernel when it is first launched with a size of work-group. Seconds; measured 20 to 90.
constexpr double kLlvmpipeCompiles_s = 150;

// Returns why there is no trial; nothing: the kernels have passed. Throws Error if they have not.
Problem try_kernels(const TrialJob& job) {
    std::vector<std::string> libraries;
    for (const auto& [loaded, original] : job.libraries) {
        if (loaded != original) note_private_copy(loaded, original);
        libraries.push_back(loaded);
    }
    number_surface_models(job.surfaces);
    const PluginRegistry plugins = PluginRegistry::of(libraries);
    std::shared_ptr<Device> device;
    try {
        device = std::make_shared<Device>(choose_device(job.device));
    } catch (const Error& e) {
        return e.what();
    }
    if (device->info().name != job.device_name) return "device " + job.device + " is " + device->info().name + " here";
    const TrialSteps steps = [more_s = device->info().llvmpipe ? kLlvmpipeCompiles_s : 0](
                                 const std::string& step, double limit_s) { worker::say_step(step, limit_s + more_s); };
    return job.kernels == kFilmKernels ? try_film_kernels(device, steps) : try_on_small_scene(job, plugins, device, steps);
}

void trial_job(ParcelReader& arguments) {
    const auto job = worker::arguments_in<TrialJob>(arguments);
    worker::enter_sandbox(worker::WorkerKind::driver);
    worker::answer(try_kernels(job).text());
}

}  // namespace

const worker::JobKind& trial_worker() {
    static const worker::JobKind kind = [] {
        worker::JobKind with_work = kTrialJob;
        with_work.main = trial_job;
        return with_work;
    }();
    return kind;
}

}  // namespace clarity
