// frames.cpp -- the film, and tracing into it.
#include <algorithm>
#include <chrono>
#include <cstring>

#include "render/film.hpp"
#include "render/frame_constants.hpp"
#include "render/guarded.hpp"
#include "render/launch.hpp"
#include "render/ray_queries.hpp"
#include "render/renderer.hpp"
#include "render/trace_program.hpp"
#include "render/view_buffers.hpp"
#include "render/wavefront.hpp"

namespace clarity {
namespace {

unsigned channels_of(const std::string& aov) {
    if (aov == "color") return 4;
    return aov == "normal" || aov == "uv" ? 3 : 1;
}

// A packet's distances, block by block, to where its first pixel is.
void put_packet(const Layout& layout, const float* block, unsigned left, unsigned top, FloatImage& image) {
    const unsigned right = std::min(left + layout.packet_w, image.width),
                   bottom = std::min(top + layout.packet_h, image.height);
    for (unsigned y0 = top; y0 < top + layout.packet_h; y0 += layout.block_h)
        for (unsigned x0 = left; x0 < left + layout.packet_w; x0 += layout.block_w, block += layout.lanes) {
            if (x0 >= right) continue;
            const unsigned width = std::min(layout.block_w, right - x0),
                           height = y0 < bottom ? std::min(layout.block_h, bottom - y0) : 0;
            float* to = &image.pixels[size_t(y0) * image.width + x0];
            for (unsigned row = 0; row < height; ++row, to += image.width) {
                const float* from = block + row * layout.block_w;
                if (width == 4)
                    std::memcpy(to, from, 4 * sizeof(float));  // of a size that the compiler knows
                else
                    std::copy_n(from, width, to);
            }
        }
}

// Rays are stored by groups, packets, blocks and lanes, as rt_packet_origin() and rt_block_pixels() number them.
void put_in_order(const Layout& layout, const float* stored, FloatImage& image) {
    const unsigned groups_x = layout.groups_x(image.width), groups_y = layout.groups_y(image.height);
    for (unsigned y = 0; y < groups_y; ++y)
        for (unsigned x = 0; x < groups_x; ++x)
            for (unsigned in_y = 0; in_y < layout.group_h; ++in_y)
                for (unsigned in_x = 0; in_x < layout.group_w; ++in_x, stored += layout.rays())
                    put_packet(layout, stored, (x * layout.group_w + in_x) * layout.packet_w,
                               (y * layout.group_h + in_y) * layout.packet_h, image);
}

}  // namespace

struct Frames::Impl {
    explicit Impl(const std::shared_ptr<Device>& d) : device(d), film_kernels(d), queries(d), wavefront(d) {}

    std::shared_ptr<Device> device;
    FilmKernels film_kernels;
    RayQueries queries;
    Wavefront wavefront;
    ViewBuffers view;
    GrowingBuffer film{CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR}, counters{CL_MEM_READ_WRITE}, distances{CL_MEM_READ_WRITE};
    unsigned width = 0, height = 0;
    std::string aov;
    Layout layout;                                // of the picture in the film
    std::shared_ptr<const TraceProgram> program;  // whose pace and kernel these are:
    std::shared_ptr<const DeviceScene> bound;
    cl::Kernel kernel;
    Launcher launcher;
    std::vector<uint8_t> false_picture;
    std::vector<float> scratch;  // kept: fresh pages cost more than what is done with them

    // Waits for all that is queued.
    void read(const cl::Buffer& buffer, void* out, size_t bytes) {
        device->queue().enqueueReadBuffer(buffer, CL_TRUE, 0, bytes, out);
    }
};

Frames::Frames(std::shared_ptr<Device> device) : impl_(std::make_unique<Impl>(device)) {}
Frames::~Frames() = default;

FrameStats Frames::trace(const Prepared& prepared, const Settings& settings, const View& view, unsigned sample, bool count_rays,
                         Progress& progress) {
    Impl& im = *impl_;
    return guarded(*im.device, "tracing", [&] {
        const TraceProgram& program = *prepared.program;
        const unsigned width = static_cast<unsigned>(settings.width), height = static_cast<unsigned>(settings.height);
        cl::CommandQueue& queue = im.device->queue();
        const cl::Context& context = im.device->context();
        if (im.program != prepared.program || im.bound != prepared.on_device || width != im.width || height != im.height)
            im.launcher.forget();
        if (im.program != prepared.program) im.kernel = program.kernel();
        im.program = prepared.program;
        im.bound = prepared.on_device;
        im.aov = prepared.settings.aov;
        im.width = width;
        im.height = height;

        const size_t pixels = size_t(width) * height;
        const Layout layout = im.layout = make_layout(prepared.settings, im.device->info().cpu);
        const unsigned groups = layout.groups_x(width) * layout.groups_y(height);
        const unsigned packets = groups * layout.group_packets();
        im.view.write(queue, *prepared.scene, make_frame(view, settings, layout, *prepared.accel, sample), view);

        const auto go_on = [&] {
            if (progress.cancelled()) throw Cancelled();
        };
        const cl::Buffer& film = im.film.fit(context, FilmKernels::room(pixels) * channels_of(im.aov) * sizeof(float));
        if (program.has_generations()) im.distances.fit(context, size_t(packets) * layout.rays() * sizeof(float));
        LaunchTimes times;
        if (program.is_wavefront()) {
            const auto depth = static_cast<unsigned>(settings.depth);
            times = im.wavefront.trace(
                queue, im.launcher,
                {prepared, view, im.view, layout, width, height, depth, sample, film, im.distances.get()}, go_on);
        } else {
            cl_uint at = 0;
            im.kernel.setArg(at++, im.view.frame());
            const cl_uint first_group = at++;
            im.kernel.setArg(at++, film);
            if (program.has_generations()) {
                im.kernel.setArg(at++, im.counters.fit(context, size_t(packets) * 16));
                im.kernel.setArg(at++, im.distances.get());
            }
            im.view.bind(*prepared.on_device, im.kernel, at);
            times = im.launcher.run(queue, im.kernel, first_group, groups, layout.local_size(), go_on);
        }

        FrameStats stats;
        stats.device_ms = times.device_ms;
        stats.wall_ms = times.wall_ms;
        stats.primary = pixels;
        stats.samples = sample + 1;
        stats.kernels.push_back({"trace", times.device_ms});
        if (program.has_generations() && count_rays) {
            stats.kernels.emplace_back();
            const bool wave = program.is_wavefront();
            const RayCounts counts = im.film_kernels.sum(wave ? im.wavefront.counters() : im.counters.get(),
                                                         wave ? im.wavefront.counter_count() : packets, stats.kernels.back());
            stats.shadow = counts.shadow;
            stats.secondary = counts.secondary;
            stats.dropped = counts.dropped;
            stats.overflowed = counts.overflowed;
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
        im.read(im.film.get(), film.data(), film.size() * sizeof(float));
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
    Impl& im = *impl_;
    if (im.aov == "t") return read_values();
    if (!im.program || !im.program->has_generations()) return {};
    return guarded(*im.device, "reading distances", [&] {
        const Layout& layout = im.layout;
        const unsigned groups = layout.groups_x(im.width) * layout.groups_y(im.height);
        im.scratch.resize(size_t(groups) * layout.group_packets() * layout.rays());
        im.read(im.distances.get(), im.scratch.data(), im.scratch.size() * sizeof(float));
        FloatImage image;
        image.width = im.width;
        image.height = im.height;
        image.channels = 1;
        image.pixels.resize(size_t(im.width) * im.height);
        put_in_order(layout, im.scratch.data(), image);
        return image;
    });
}

ByteImage Frames::read_display(const Settings& settings) {
    ByteImage image;
    image.width = impl_->width;
    image.height = impl_->height;
    image.pixels.resize(size_t(image.width) * image.height * 4);
    read_display(settings, image.pixels.data());
    return image;
}

FalseColorScale Frames::read_display(const Settings& settings, uint8_t* rgba, FrameStats* stats) {
    Impl& im = *impl_;
    if (im.aov != "color") {
        using Clock = std::chrono::steady_clock;
        const auto begin = Clock::now();
        const FloatImage values = read_values();
        const auto read = Clock::now();
        const FalseColorScale scale = scale_of(values, im.aov, static_cast<float>(settings.scale_max));
        false_colors(values, im.aov, scale, rgba);
        if (stats) {
            stats->kernels.push_back({"read-back", std::chrono::duration<double, std::milli>(read - begin).count()});
            stats->kernels.push_back({"false colours", std::chrono::duration<double, std::milli>(Clock::now() - read).count()});
        }
        return scale;
    }
    guarded(*im.device, "reading the picture", [&] {
        im.film_kernels.show(im.film.get(), size_t(im.width) * im.height, settings, rgba, stats ? &stats->kernels : nullptr);
    });
    return {};
}

const uint8_t* Frames::look_at_display(const Settings& settings, FrameStats* stats, FalseColorScale* scale) {
    Impl& im = *impl_;
    const size_t pixels = size_t(im.width) * im.height;
    if (im.aov != "color") {
        im.false_picture.resize(pixels * 4);
        const FalseColorScale found = read_display(settings, im.false_picture.data(), stats);
        if (scale) *scale = found;
        return im.false_picture.data();
    }
    if (scale) *scale = {};
    return guarded(*im.device, "reading the picture",
                   [&] { return im.film_kernels.show(im.film.get(), pixels, settings, stats ? &stats->kernels : nullptr); });
}

std::vector<rt_hit> Frames::trace_rays(const Prepared& prepared, const std::vector<rt_ray>& rays, RayQuery query,
                                       double* device_ms) {
    std::vector<rt_hit> hits;
    const double ms = trace_rays(prepared, RayBlocks(rays, unsigned(prepared.settings.lanes)), query, &hits);
    if (device_ms) *device_ms = ms;
    return hits;
}

double Frames::trace_rays(const Prepared& prepared, const RayBlocks& rays, RayQuery query, std::vector<rt_hit>* hits) {
    return impl_->queries.trace(prepared, rays, query, hits);
}

}  // namespace clarity
