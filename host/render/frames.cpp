// frames.cpp -- the film, and tracing into it.
#include <algorithm>
#include <cstring>
#include <numeric>
#include <utility>

#include "render/bands.hpp"
#include "render/display_relay.hpp"
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
void put_in_order(const Layout& layout, const std::vector<rt_u32>& rows, const float* stored, FloatImage& image) {
    const unsigned groups_x = layout.groups_x(image.width);
    for (const rt_u32 y : rows)
        for (unsigned x = 0; x < groups_x; ++x)
            for (unsigned in_y = 0; in_y < layout.group_h; ++in_y)
                for (unsigned in_x = 0; in_x < layout.group_w; ++in_x, stored += layout.rays())
                    put_packet(layout, stored, (x * layout.group_w + in_x) * layout.packet_w,
                               (y * layout.group_h + in_y) * layout.packet_h, image);
}

}  // namespace

struct Frames::Impl {
    explicit Impl(const std::shared_ptr<Device>& d)
        : device(d), film_kernels(d), relay(d, film_kernels), queries(d), wavefront(d) {}

    std::shared_ptr<Device> device;
    FilmKernels film_kernels;
    DisplayRelay relay;
    RayQueries queries;
    Wavefront wavefront;
    ViewBuffers view;
    GrowingBuffer film{CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR}, counters{CL_MEM_READ_WRITE}, distances{CL_MEM_READ_WRITE};
    unsigned width = 0, height = 0;
    std::string aov;
    Layout layout;                                // of the picture in the film
    std::vector<rt_u32> rows;                     // of work-groups, that are traced; counters and distances are in this order
    std::shared_ptr<const TraceProgram> program;  // whose pace and kernel these are:
    std::shared_ptr<const DeviceScene> bound;
    cl::Kernel kernel;
    Launcher launcher;
    enum class Shown { no, read, begun };
    Shown shown = Shown::no;     // the picture before: then this one will be
    std::vector<float> scratch;  // kept: fresh pages cost more than what is done with them

    // Waits for all that is queued.
    void read(const cl::Buffer& buffer, void* out, size_t bytes) {
        device->queue().enqueueReadBuffer(buffer, CL_TRUE, 0, bytes, out);
    }

    void take_rows(const SharedRows* shared) {
        if (shared) {
            rows = shared->rows;
            return;
        }
        rows.resize(layout.groups_y(height));
        std::iota(rows.begin(), rows.end(), 0u);
    }
    std::vector<Band> bands(size_t begin = 0) const {
        const std::vector<rt_u32> some(rows.begin() + static_cast<std::ptrdiff_t>(begin), rows.end());
        return bands_of(some, layout.group_h * layout.packet_h, height);
    }
    cl::Event begin_sum() {
        if (program->is_wavefront()) return film_kernels.begin_sum(wavefront.counters(), wavefront.counter_count());
        return film_kernels.begin_sum(counters.get(), groups() * layout.group_packets());
    }
    void end_sum(FrameStats& stats) {
        stats.kernels.emplace_back();
        const RayCounts counts = film_kernels.end_sum(stats.kernels.back());
        stats.shadow = counts.shadow;
        stats.secondary = counts.secondary;
        stats.dropped = counts.dropped;
        stats.overflowed = counts.overflowed;
    }
    ColorFilm film_of_colors() const { return {film.get(), width, height}; }
    unsigned groups() const { return layout.groups_x(width) * static_cast<unsigned>(rows.size()); }
    FloatImage image(unsigned channels) const {
        FloatImage image{width, height, channels, {}};
        image.pixels.resize(size_t(width) * height * channels);
        return image;
    }
};

Frames::Frames(std::shared_ptr<Device> device) : impl_(std::make_unique<Impl>(device)) {}
Frames::~Frames() = default;

FrameStats Frames::trace(const Prepared& prepared, const Settings& settings, const View& view, unsigned sample, bool count_rays,
                         Progress& progress, const SharedRows* shared, const std::function<void()>& meanwhile) {
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
        const unsigned packets = layout.groups_x(width) * layout.groups_y(height) * layout.group_packets();
        im.take_rows(shared);
        const unsigned begin = shared ? layout.groups_x(width) * static_cast<unsigned>(shared->begin) : 0;
        rt_frame frame = make_frame(view, settings, layout, *prepared.accel, sample);
        std::vector<rt_u32> table;
        if (shared) {
            frame.row_count = static_cast<rt_u32>(im.rows.size());
            table = im.rows;
            table.resize(layout.groups_y(height));  // so that the buffer does not grow row by row
        }
        im.view.write(queue, *prepared.scene, frame, view, table);

        const auto go_on = [&] {
            if (progress.cancelled()) throw Cancelled();
        };
        const cl::Buffer& film = im.film.fit(context, FilmKernels::room(pixels) * film_channels(im.aov) * sizeof(float));
        if (program.has_generations()) im.distances.fit(context, size_t(packets) * layout.rays() * sizeof(float));
        const unsigned groups = im.groups() - begin;
        // Who was shown the last picture gets this one by a single wait, not by one for the trace and one for the copy.
        Beside beside{{}, meanwhile};
        im.relay.forget_begun();
        const Impl::Shown before = std::exchange(im.shown, Impl::Shown::no);
        const bool show = im.aov == "color" && !shared && !im.device->info().cpu && before != Impl::Shown::no;
        const bool sum = count_rays && program.has_generations() && groups > 0;
        if (sum || show)
            beside.behind = [&] {
                const cl::Event summed = sum ? im.begin_sum() : cl::Event();
                return show ? im.relay.begin(im.film_of_colors(), settings, before == Impl::Shown::begun) : summed;
            };
        LaunchTimes times;
        if (program.is_wavefront()) {
            const auto depth = static_cast<unsigned>(settings.depth);
            times = im.wavefront.trace(
                queue, im.launcher,
                {prepared, view, im.view, layout, width, height, begin, groups, depth, sample, film, im.distances.get()}, go_on,
                beside);
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
            times = im.launcher.run(queue, im.kernel, first_group, groups, layout.local_size(), go_on, begin, beside);
        }

        FrameStats stats;
        stats.device_ms = times.device_ms;
        stats.wall_ms = times.wall_ms;
        stats.launches = times.launches;
        for (const Band& band : im.bands(shared ? shared->begin : 0)) stats.primary += uint64_t(band.count) * width;
        stats.samples = sample + 1;
        stats.kernels.push_back({"trace", times.device_ms});
        if (sum) im.end_sum(stats);
        return stats;
    });
}

void Frames::count(FrameStats& stats) {
    Impl& im = *impl_;
    if (!im.program || !im.program->has_generations() || im.rows.empty()) return;
    guarded(*im.device, "counting rays", [&] {
        im.begin_sum();
        im.end_sum(stats);
    });
}

FloatImage Frames::read_values() {
    FloatImage image = impl_->image(value_channels(impl_->aov));
    read_values(image);
    return image;
}

void Frames::read_values(FloatImage& image) {
    Impl& im = *impl_;
    guarded(*im.device, "reading the film", [&] {
        const bool color = im.aov == "color";
        const size_t stored = size_t(im.width) * film_channels(im.aov);  // floats of a row of pixels
        if (color) im.scratch.resize(stored * im.height);
        float* const film = color ? im.scratch.data() : image.pixels.data();
        const std::vector<Band> bands = im.bands();
        read_bands(im.device->queue(), im.film.get(), bands, stored * sizeof(float), film);
        im.device->queue().finish();
        for (const Band& band : bands) {
            const size_t begin = band.first * size_t(im.width), end = begin + band.count * size_t(im.width);
            if (color) {
                for (size_t i = begin; i < end; ++i)
                    for (int k = 0; k < 3; ++k) image.pixels[3 * i + k] = film[4 * i + k] / std::max(film[4 * i + 3], 1.0f);
            } else if (im.aov == "prim" || im.aov == "instance") {
                for (size_t i = begin; i < end; ++i) {
                    rt_i32 number;
                    std::memcpy(&number, &film[i], sizeof number);
                    film[i] = static_cast<float>(number);
                }
            }
        }
    });
}

FloatImage Frames::read_distance() {
    FloatImage image = impl_->image(1);
    return read_distance(image) ? image : FloatImage{};
}

bool Frames::read_distance(FloatImage& image) {
    Impl& im = *impl_;
    if (im.aov == "t") {
        read_values(image);
        return true;
    }
    if (!im.program || !im.program->has_generations()) return false;
    guarded(*im.device, "reading distances", [&] {
        im.scratch.resize(size_t(im.groups()) * im.layout.group_packets() * im.layout.rays());
        if (!im.scratch.empty()) im.read(im.distances.get(), im.scratch.data(), im.scratch.size() * sizeof(float));
        put_in_order(im.layout, im.rows, im.scratch.data(), image);
    });
    return true;
}

void Frames::read_display(const Settings& settings, uint8_t* rgba, std::vector<KernelTime>* times) {
    Impl& im = *impl_;
    if (im.rows.empty()) return;
    guarded(*im.device, "reading the picture", [&] {
        im.film_kernels.show_rows(im.film.get(), im.width, im.height, im.rows, im.layout.group_h * im.layout.packet_h, settings,
                                  rgba, times);
    });
}

ByteImage Frames::read_display(const Settings& settings, FrameStats* stats, FalseColorScale* scale) {
    Impl& im = *impl_;
    if (scale) *scale = {};
    if (im.aov != "color") return show_values([this] { return read_values(); }, im.aov, settings, stats, scale);
    im.shown = Impl::Shown::read;
    return guarded(*im.device, "reading the picture", [&] { return im.relay.take(im.film_of_colors(), settings, false); })
        .wait(stats ? &stats->kernels : nullptr);
}

PendingImage Frames::begin_display(const Settings& settings) {
    Impl& im = *impl_;
    im.shown = Impl::Shown::begun;
    return guarded(*im.device, "reading the picture", [&] { return im.relay.take(im.film_of_colors(), settings, true); });
}

bool Frames::copies_aside() const {
    return impl_->aov == "color" && !impl_->device->info().cpu;
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
