// frames.cpp -- the film, and tracing into it.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "device/kernel_files.hpp"
#include "device/program.hpp"
#include "render/device_scene.hpp"
#include "render/frame_constants.hpp"
#include "render/launch.hpp"
#include "render/renderer.hpp"
#include "render/trace_program.hpp"

namespace clarity {
namespace {

unsigned channels_of(const std::string& aov) {
    if (aov == "color") return 4;
    return aov == "normal" || aov == "uv" ? 3 : 1;
}

// Kernels look materials and textures up by number.
void check_materials(const Scene& scene, const std::vector<rt_material>& materials) {
    if (materials.empty()) return;
    if (materials.size() != scene.materials.size())
        throw Error(Exit::failed, "the view brings " + std::to_string(materials.size()) + " materials and the scene has " +
                                      std::to_string(scene.materials.size()) + ": one for each is needed");
    for (size_t i = 0; i < materials.size(); ++i)
        if (materials[i].texture != RT_NONE && materials[i].texture >= scene.textures.size())
            throw Error(Exit::failed, "material " + std::to_string(i) + " of the view names texture " +
                                          std::to_string(materials[i].texture) + " and the scene has " +
                                          std::to_string(scene.textures.size()));
}

template <class Work>
auto guarded(const Device& device, const char* doing, Work&& work) {
    try {
        return work();
    } catch (const cl::Error& e) {
        throw Error(Exit::failed, std::string(doing) + " on " + device.info().name + ": " + e.what() +
                                      " failed with OpenCL error " + std::to_string(e.err()) +
                                      (e.err() == CL_MEM_OBJECT_ALLOCATION_FAILURE ? " (out of memory)" : ""));
    }
}

}  // namespace

struct Frames::Impl {
    std::shared_ptr<Device> device;
    cl::Program film_program;
    cl::Kernel map_tones, sum_counters;
    cl::Buffer film, display, counters, sums, frame, lights, materials;
    size_t film_bytes = 0, display_bytes = 0, counters_bytes = 0, lights_bytes = 0, materials_bytes = 0;
    unsigned width = 0, height = 0, samples = 0;
    std::string aov;
    std::shared_ptr<const TraceProgram> program;  // whose pace and kernel these are:
    std::shared_ptr<const DeviceScene> bound;
    cl::Kernel kernel;
    Launcher launcher;
    std::unique_ptr<ProgramCache> ray_programs;

    cl::Buffer& fit(cl::Buffer& buffer, size_t& has, size_t wants, cl_mem_flags flags) {
        if (has < wants || has == 0) {
            buffer = cl::Buffer();
            buffer = cl::Buffer(device->context(), flags, std::max<size_t>(wants, 256));
            has = wants;
        }
        return buffer;
    }

    // Waits for all that is queued.
    void read(const cl::Buffer& buffer, void* out, size_t bytes) {
        device->queue().enqueueReadBuffer(buffer, CL_TRUE, 0, bytes, out);
    }
};

Frames::Frames(std::shared_ptr<Device> device) : impl_(std::make_unique<Impl>()) {
    impl_->device = device;
    const BuildResult built = build_program(*device, kernel_text("film.cl"), "-cl-std=CL1.2", "film");
    guarded(*device, "preparing the film", [&] {
        impl_->film_program = built.program;
        impl_->map_tones = cl::Kernel(built.program, "map_tones");
        impl_->sum_counters = cl::Kernel(built.program, "sum_counters");
        impl_->frame = cl::Buffer(device->context(), CL_MEM_READ_ONLY, sizeof(rt_frame));
        impl_->sums = cl::Buffer(device->context(), CL_MEM_READ_WRITE, 16);
    });
    impl_->ray_programs = std::make_unique<ProgramCache>(device);
}
Frames::~Frames() = default;

FrameStats Frames::trace(const Prepared& prepared, const Settings& settings, const View& view, unsigned sample, bool count_rays,
                         Progress& progress) {
    Impl& im = *impl_;
    return guarded(*im.device, "tracing", [&] {
        const TraceProgram& program = *prepared.program;
        const bool color = program.kind == KernelKind::color;
        const unsigned width = static_cast<unsigned>(settings.width), height = static_cast<unsigned>(settings.height);
        cl::CommandQueue& queue = im.device->queue();
        if (im.program != prepared.program || im.bound != prepared.on_device || width != im.width || height != im.height)
            im.launcher.forget();
        if (im.program != prepared.program) im.kernel = program.kernel();
        im.program = prepared.program;
        im.bound = prepared.on_device;
        im.aov = prepared.settings.aov;
        im.width = width;
        im.height = height;

        const size_t pixels = size_t(width) * height;
        const Layout layout = make_layout(prepared.settings, im.device->info().cpu);
        const unsigned groups = layout.groups_x(width) * layout.groups_y(height);
        const unsigned packets = groups * layout.group_packets();
        im.fit(im.film, im.film_bytes, pixels * channels_of(im.aov) * sizeof(float), CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR);
        if (color) im.fit(im.counters, im.counters_bytes, size_t(packets) * 16, CL_MEM_READ_WRITE);
        im.fit(im.lights, im.lights_bytes, view.lights.size() * sizeof(rt_light), CL_MEM_READ_ONLY);
        const rt_frame frame = make_frame(view, settings, layout, *prepared.accel, sample);
        queue.enqueueWriteBuffer(im.frame, CL_TRUE, 0, sizeof frame, &frame);
        if (!view.lights.empty())
            queue.enqueueWriteBuffer(im.lights, CL_TRUE, 0, view.lights.size() * sizeof(rt_light), view.lights.data());

        check_materials(*prepared.scene, view.materials);
        if (!view.materials.empty()) {
            const size_t bytes = view.materials.size() * sizeof(rt_material);
            im.fit(im.materials, im.materials_bytes, bytes, CL_MEM_READ_ONLY);
            queue.enqueueWriteBuffer(im.materials, CL_TRUE, 0, bytes, view.materials.data());
        }

        cl_uint at = 0;
        im.kernel.setArg(at++, im.frame);
        const cl_uint first_group = at++;
        im.kernel.setArg(at++, im.film);
        if (color) im.kernel.setArg(at++, im.counters);
        prepared.on_device->bind(im.kernel, at, im.lights, view.materials.empty() ? nullptr : &im.materials);
        const LaunchTimes times = im.launcher.run(queue, im.kernel, first_group, groups, layout.local_size(), [&] {
            if (progress.cancelled()) throw Cancelled();
        });

        FrameStats stats;
        stats.device_ms = times.device_ms;
        stats.wall_ms = times.wall_ms;
        stats.primary = pixels;
        stats.samples = im.samples = sample + 1;
        stats.kernels.push_back({"trace", times.device_ms});
        if (color && count_rays) {
            cl_uint sums[4] = {};
            queue.enqueueWriteBuffer(im.sums, CL_TRUE, 0, sizeof sums, sums);
            im.sum_counters.setArg(0, im.counters);
            im.sum_counters.setArg(1, packets);
            im.sum_counters.setArg(2, im.sums);
            queue.enqueueNDRangeKernel(im.sum_counters, cl::NullRange, cl::NDRange(1024), cl::NDRange(64));
            im.read(im.sums, sums, sizeof sums);
            stats.shadow = sums[0];
            stats.secondary = sums[1];
            stats.dropped = sums[2];
            stats.overflowed = sums[3];
        }
        return stats;
    });
}

FloatImage Frames::read_values() {
    Impl& im = *impl_;
    return guarded(*im.device, "reading the film", [&] {
        const unsigned stored = channels_of(im.aov);
        FloatImage image;
        image.width = im.width;
        image.height = im.height;
        image.channels = im.aov == "color" ? 3 : stored;
        const size_t pixels = size_t(im.width) * im.height;
        std::vector<float> film(pixels * stored);
        im.read(im.film, film.data(), film.size() * sizeof(float));
        if (im.aov == "color") {
            image.pixels.resize(pixels * 3);
            for (size_t i = 0; i < pixels; ++i)
                for (int k = 0; k < 3; ++k) image.pixels[3 * i + k] = film[4 * i + k] / std::max(film[4 * i + 3], 1.0f);
            return image;
        }
        if (im.aov == "prim" || im.aov == "instance")
            for (float& value : film) {
                rt_i32 number;
                std::memcpy(&number, &value, sizeof number);
                value = static_cast<float>(number);
            }
        image.pixels = std::move(film);
        return image;
    });
}

FloatImage Frames::read_distance() {
    return impl_->aov == "t" ? read_values() : FloatImage();
}

ByteImage Frames::read_display(const Settings& settings) {
    ByteImage image;
    image.width = impl_->width;
    image.height = impl_->height;
    image.pixels.resize(size_t(image.width) * image.height * 4);
    read_display(settings, image.pixels.data());
    return image;
}

FalseColorScale Frames::read_display(const Settings& settings, uint8_t* rgba, FrameStats*) {
    Impl& im = *impl_;
    if (im.aov != "color") {
        const FloatImage values = read_values();
        const FalseColorScale scale = scale_of(values, im.aov, static_cast<float>(settings.scale_max));
        false_colors(values, im.aov, scale, rgba);
        return scale;
    }
    guarded(*im.device, "reading the picture", [&] {
        const size_t pixels = size_t(im.width) * im.height;
        im.fit(im.display, im.display_bytes, pixels * 4, CL_MEM_WRITE_ONLY | CL_MEM_ALLOC_HOST_PTR);
        im.map_tones.setArg(0, im.film);
        im.map_tones.setArg(1, im.display);
        im.map_tones.setArg(2, static_cast<cl_uint>(pixels));
        im.map_tones.setArg(3, static_cast<float>(settings.exposure));
        im.map_tones.setArg(4, static_cast<cl_uint>(settings.tone == "reinhard" ? 1 : settings.tone == "aces" ? 2 : 0));
        im.device->queue().enqueueNDRangeKernel(im.map_tones, cl::NullRange, cl::NDRange((pixels + 63) / 64 * 64),
                                                cl::NDRange(64));
        im.read(im.display, rgba, pixels * 4);
    });
    return {};
}

std::vector<rt_hit> Frames::trace_rays(const Prepared& prepared, const std::vector<rt_ray>& rays, RayQuery query,
                                       double* device_ms) {
    Impl& im = *impl_;
    return guarded(*im.device, "tracing rays", [&] {
        std::vector<rt_hit> hits(rays.size());
        if (rays.empty()) return hits;
        const Layout layout = make_layout(prepared.settings, im.device->info().cpu);
        bool fresh = false;
        const KernelSource source =
            assemble_kernel(prepared.settings, layout, KernelKind::rays, features_of(*prepared.scene, prepared.accel->scene),
                            *prepared.accel->plugin, prepared.accel->defines);
        auto program = im.ray_programs->get(source, KernelKind::rays,
                                            std::string("ray queries with accel ") + prepared.accel->plugin->id, &fresh);
        cl::CommandQueue& queue = im.device->queue();
        cl::Context& context = im.device->context();
        const rt_frame frame = make_frame(View(), prepared.settings, layout, *prepared.accel, 0);
        queue.enqueueWriteBuffer(im.frame, CL_TRUE, 0, sizeof frame, &frame);
        im.fit(im.lights, im.lights_bytes, 1, CL_MEM_READ_ONLY);
        cl::Buffer in(context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, rays.size() * sizeof(rt_ray),
                      const_cast<rt_ray*>(rays.data()));
        cl::Buffer out(context, CL_MEM_WRITE_ONLY, rays.size() * sizeof(rt_hit));
        cl::Kernel kernel = program->kernel();
        cl_uint at = 0;
        kernel.setArg(at++, im.frame);
        const cl_uint first_group = at++;
        kernel.setArg(at++, static_cast<cl_uint>(rays.size()));
        kernel.setArg(at++, static_cast<cl_uint>(query.any_hit));
        kernel.setArg(at++, in);
        kernel.setArg(at++, out);
        prepared.on_device->bind(kernel, at, im.lights);
        const size_t per_group = size_t(layout.group_packets()) * layout.lanes;
        Launcher launcher;
        const LaunchTimes times =
            launcher.run(queue, kernel, first_group, static_cast<unsigned>((rays.size() + per_group - 1) / per_group),
                         layout.local_size(), [] {});
        if (device_ms) *device_ms = times.device_ms;
        im.read(out, hits.data(), hits.size() * sizeof(rt_hit));
        return hits;
    });
}

}  // namespace clarity
