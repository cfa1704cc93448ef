#include "frames/frame_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <utility>

#include "base/parallel_for.hpp"
#include "base/timeline.hpp"
#include "device/cl_errors.hpp"
#include "device/launch_limit.hpp"
#include "launch/frame_constants.hpp"
#include "picture/bands.hpp"
#include "picture/denoiser.hpp"
#include "picture/display_readback.hpp"
#include "picture/film.hpp"
#include "picture/film_noise.hpp"
#include "tracers/tracer.hpp"
#include "view/settings/aov.hpp"

namespace clarity {
namespace {

// Copies a packet's distances, which are stored block by block, to its pixels in the image.
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
                    std::memcpy(to, from, 4 * sizeof(float));  // a size known at compile time
                else
                    std::copy_n(from, width, to);
            }
        }
}

// Rays are stored by group, packet, block and lane, in the order of rt_packet_origin() and rt_block_pixels().
void put_in_order(const Layout& layout, const std::vector<rt_u32>& rows, const float* stored, FloatImage& image) {
    const unsigned groups_x = layout.groups_x(image.width);
    for (const rt_u32 y : rows)
        for (unsigned x = 0; x < groups_x; ++x)
            for (unsigned in_y = 0; in_y < layout.group_h; ++in_y)
                for (unsigned in_x = 0; in_x < layout.group_w; ++in_x, stored += layout.rays())
                    put_packet(layout, stored, (x * layout.group_w + in_x) * layout.packet_w,
                               (y * layout.group_h + in_y) * layout.packet_h, image);
}

// From sums of colours, with the number of samples behind each, to their means.
void divide_sums(const float* sums, float* colors, size_t pixels) {
    constexpr size_t kAtOnce = 1u << 16;
    parallel_for(static_cast<uint32_t>((pixels + kAtOnce - 1) / kAtOnce), [&](uint32_t piece) {
        const size_t end = std::min(pixels, (piece + 1) * kAtOnce);
        for (size_t i = piece * kAtOnce; i < end; ++i)
            for (int k = 0; k < 3; ++k) colors[3 * i + k] = sums[4 * i + k] / std::max(sums[4 * i + 3], 1.0f);
    });
}

// Limits of the number of samples in one launch. Each launch ends with its slowest rays, so fewer launches waste less time. But
// a launch cannot be cancelled, and each of its samples takes a layer of memory.
constexpr unsigned kMostAtOnce = 16, kShareOfMemory = 32;
constexpr double kAtOnceMs = 50;
constexpr unsigned kMostSummed = 16384;  // of a tracer that adds samples by itself, without layers

}  // namespace

struct FrameRenderer::Impl {
    explicit Impl(const std::shared_ptr<Device>& d) : device(d), film_kernels(d), relay(d, film_kernels) {}

    std::shared_ptr<Device> device;
    FilmKernels film_kernels;
    std::unique_ptr<Denoiser> denoiser;  // made when it is first asked for
    DisplayReadback relay;
    ViewBuffers view;
    GrowingBuffer film{CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR}, layers{CL_MEM_READ_WRITE}, distances{CL_MEM_READ_WRITE};
    unsigned width = 0, height = 0;
    const Aov* aov = &aov_table().front();  // the quantity in the film
    Layout layout;                          // of the picture in the film
    std::vector<rt_u32> rows;               // work-group rows that are traced; counters and distances are stored in this order
    unsigned begun = 0;                     // work-groups of these rows that earlier calls have traced
    std::vector<unsigned> resting;          // of each row of work-groups: pixels that rest; empty: none
    // The program and scene of `tracer` and of the launcher's pace.
    std::shared_ptr<const TraceProgram> program;
    std::shared_ptr<const DeviceScene> bound;
    bool bound_moves = false;  // Prepared::is_moved
    std::unique_ptr<FrameTracer> tracer;
    bool debug = false;
    bool sums_samples = false;  // the tracer has kSumsSamples
    unsigned in_launch = 1;     // then: samples of the launch of which `launcher` knows the pace
    Launcher launcher;
    // Whether and how a picture was displayed: by read_display() or by begin_display().
    enum class Shown { no, read, begun };
    // How the last picture was displayed. We expect the next one to be displayed in the same way.
    Shown shown = Shown::no;
    FloatPixels scratch;  // kept, because fresh pages cost more than the work on them

    // Waits for everything that is queued, then reads.
    void read(const cl::Buffer& buffer, void* out, size_t bytes) {
        device->queue().enqueueReadBuffer(buffer, CL_TRUE, 0, bytes, out);
    }

    // The arguments of trace().
    struct Picture {
        const Prepared& prepared;
        const Settings& settings;
        const View& view;
        const SharedRows* shared;
        Progress& progress;
    };
    void begin(const Picture& picture) {
        const Prepared& prepared = picture.prepared;
        const auto new_width = static_cast<unsigned>(picture.settings.width),
                   new_height = static_cast<unsigned>(picture.settings.height);
        // Frames of a scene that moves cost about the same: the pace is kept.
        const bool moves_on = prepared.is_moved && bound_moves;
        if (program != prepared.program || (bound != prepared.on_device && !moves_on) || width != new_width ||
            height != new_height)
            launcher.forget();
        sums_samples = prepared.program->row.has(kSumsSamples);
        if (program != prepared.program) {
            program.reset();
            tracer.reset();
            tracer = open_tracer(device, prepared.program);
        }
        program = prepared.program;
        if (bound != prepared.on_device) view.forget_emitters();  // a structure that moves may be in buffers of an earlier pose
        bound = prepared.on_device;
        bound_moves = prepared.is_moved;
        debug = prepared.settings.debug;
        aov = &find_aov(prepared.settings.aov);
        width = new_width;
        height = new_height;
        layout = prepared.layout;
        if (picture.shared) {
            rows = picture.shared->rows;
        } else {
            rows.resize(layout.groups_y(height));
            std::iota(rows.begin(), rows.end(), 0u);
        }
        begun = picture.shared ? layout.groups_x(width) * static_cast<unsigned>(picture.shared->begin) : 0;
        const size_t in_plane = size_t(width) * height;
        film.fit(device->context(), film_bytes((planes() - 1) * in_plane + FilmKernels::room(in_plane)));
        if (tracer->counts_rays())
            distances.fit(device->context(), layout.packets(width, height) * layout.rays() * sizeof(float));
    }

    // How many of the `left` samples the next launch traces.
    unsigned samples_at_once(const Picture& picture, unsigned left) const {
        if (sums_samples) {
            const double most = std::min(double(kMostSummed), kAtOnceMs * in_launch / launcher.expected_ms(groups()));
            return std::min(left, static_cast<unsigned>(std::max(1.0, most)));
        }
        if (layout.cpu || layout.max_pixels > 1 || layout.lanes > 1 || !aov->is_color() || begun > 0 ||
            !tracer->takes_layers(picture.prepared, picture.view))
            return 1;
        const DeviceInfo& info = device->info();
        uint64_t room = info.global_bytes / kShareOfMemory;
        if (info.max_allocation_bytes) room = std::min(room, info.max_allocation_bytes);
        const uint64_t fitting = room / film_bytes(size_t(width) * height);
        const double most = std::min({double(kMostAtOnce), double(fitting), kAtOnceMs / launcher.expected_ms(groups())});
        if (most < 2) return 1;
        const auto launches = static_cast<unsigned>(std::ceil(left / std::floor(most)));
        return (left + launches - 1) / launches;
    }

    // Traces samples [sample, sample + at_once) into the film, or each into its own layer if there are several.
    LaunchTimes launch(const Picture& picture, unsigned sample, unsigned at_once, const cl::Buffer& into,
                       const SideWork& side_work) {
        const auto& [prepared, settings, view_of, shared, progress] = picture;
        Queue& queue = device->queue();
        const unsigned layers = sums_samples ? 1 : at_once;
        std::vector<rt_frame> frames;
        for (unsigned layer = 0; layer < layers; ++layer) {
            frames.push_back(make_frame(view_of, settings, layout, *prepared.accel, sample + layer));
            frames.back().layers = layers - layer;
            frames.back().samples = at_once / layers;
            if (layers > 1) frames.back().adds = 0;
            if (shared) frames.back().row_count = static_cast<rt_u32>(rows.size());
        }
        if (sums_samples) launcher.slow_down(double(at_once) / std::exchange(in_launch, at_once));
        std::vector<rt_u32> table;
        if (shared) {
            table = rows;
            table.resize(layout.groups_y(height));  // full size, so that the buffer does not grow row by row
        }
        view.write(queue, *prepared.scene, *prepared.on_device, frames, view_of, table);
        if (program->row.has(kPicksLights))
            view.write_emitters(queue, *prepared.scene, prepared.accel, view_of, prepared.settings,
                                prepared.is_moved ? prepared.on_device.get() : nullptr);

        const auto go_on = [&progress = picture.progress] {
            if (progress.cancelled()) throw Cancelled();
        };
        const unsigned launched = layers * groups() - begun;
        const FrameLaunch frame{prepared, settings, view_of, view, queue, into, distances.get(), begun, launched, sample};
        return tracer->trace(launcher, frame, go_on, side_work);
    }

    unsigned planes() const { return film_planes(program->row); }
    size_t film_bytes(size_t of_pixels) const { return of_pixels * aov->film_channels() * sizeof(float); }
    void read_statistics(FloatImage& image) {
        const size_t plane = size_t(width) * height * 4;
        scratch.resize(plane * planes());
        for (unsigned p = 0; p < planes(); ++p)
            read_bands(device->queue(), film.get(), in_plane(p, group_rows().bands()), film_bytes(width), scratch.data());
        finish(*device, device->queue(), "reading the film");
        for (const Band& band : group_rows().bands())
            for (size_t i = band.first * size_t(width), end = i + band.count * size_t(width); i < end; ++i)
                image.pixels[i] = aov->statistic(&scratch[4 * i], &scratch[RT_PLANE_REST * plane + 4 * i]);
    }
    // Rows of a plane, counted from the film's first row on.
    std::vector<Band> in_plane(unsigned plane, std::vector<Band> bands) const {
        for (Band& band : bands) band.first += plane * height;
        return bands;
    }
    GroupRows group_rows() const { return {width, height, layout.row_height(), rows}; }
    // Pixels to which this call adds samples.
    uint64_t pixels() const {
        const size_t first = begun / layout.groups_x(width);
        uint64_t count = group_rows().pixels(first);
        for (size_t i = first; i < rows.size() && !resting.empty(); ++i) count -= resting[rows[i]];
        return count;
    }
    // Counts the pixels of these rows that rest: film_noise.hpp.
    void count_resting(const FloatImage& sums, const GroupRows& written) {
        resting.resize(layout.groups_y(height));
        for (const rt_u32 row : written.rows) {
            const size_t from = size_t(row) * written.row_pixels(),
                         end = std::min(from + written.row_pixels(), size_t(width) * height);
            const float* const deviations = sums.pixels.data() + RT_PLANE_REST * size_t(width) * height * 4;
            resting[row] = 0;
            for (size_t i = from; i < end; ++i) resting[row] += is_resting(deviations[4 * i + 3]);
        }
    }
    void end_sum(FrameStats& stats) {
        stats.kernels.emplace_back();
        RayCounts counts = tracer->end_count(film_kernels, stats.kernels.back(), debug);
        counts.primary = stats.primary;
        static_cast<RayCounts&>(stats) = counts;
    }
    // Debug programs that trace only camera rays have no ray counters, so they count full stacks separately.
    bool counts_overflows() const { return debug && !tracer->counts_rays(); }
    cl::Event begin_rows(const Settings& settings, uint8_t* rgba) {
        return film_kernels.begin_rows(film.get(), group_rows(), settings, rgba);
    }
    // Of the whole picture.
    ColorFilm film_of_colors(const Settings& settings) {
        if (!denoises(settings) || !program->row.has(kGuides)) return {film.get(), width, height};
        if (!denoiser) denoiser = std::make_unique<Denoiser>(device);
        cl::Event first, last;
        const cl::Buffer& filtered = denoiser->run(film.get(), width, height, first, last);
        return {filtered, width, height, first, last};
    }
    unsigned groups() const { return layout.groups_x(width) * static_cast<unsigned>(rows.size()); }
    FloatImage image(unsigned channels) const {
        FloatImage image{width, height, channels, {}};
        image.pixels.resize(size_t(width) * height * channels);
        return image;
    }
};

FrameRenderer::FrameRenderer(std::shared_ptr<Device> device) : impl_(std::make_unique<Impl>(device)) {}
FrameRenderer::~FrameRenderer() {
    if (impl_->device->loss()->stuck()) never_release(std::shared_ptr<Impl>(std::move(impl_)));
}

FrameStats FrameRenderer::trace(const Prepared& prepared, const Settings& settings, const View& view, const Samples& samples,
                                bool count_rays, Progress& progress, const SharedRows* shared,
                                const std::function<void()>& meanwhile) {
    Impl& im = *impl_;
    if (im.device->loss()->lost())
        throw Error(Exit::failed, im.device->info().name + " has failed before: it has to be opened anew");
    prepared.expect_known(view);
    return wrap_cl_errors(*im.device, "tracing", [&] {
        const timeline::Scope span("frame", "trace samples");
        const Impl::Picture picture{prepared, settings, view, shared, progress};
        im.begin(picture);
        if (samples.first == 0) im.resting.clear();
        // If the last picture was displayed, tone mapping and copy are queued right behind the trace, so that the host waits
        // once instead of twice.
        im.relay.forget_begun();
        const Impl::Shown before = std::exchange(im.shown, Impl::Shown::no);
        const bool show = im.aov->is_color() && !shared && !im.device->info().cpu && before != Impl::Shown::no;
        const bool sum = count_rays && im.tracer->counts_rays() && im.groups() > im.begun;
        FrameStats stats;
        for (unsigned sample = samples.first, end = sample + samples.count; sample < end;) {
            const unsigned at_once = im.samples_at_once(picture, end - sample);
            const bool in_layers = at_once > 1 && !im.sums_samples;
            const cl::Buffer& film = im.film.get();
            const cl::Buffer& into =
                !in_layers ? film : im.layers.fit(im.device->context(), im.film_bytes(size_t(im.width) * im.height * at_once));
            const bool first = sample == samples.first, last = sample + at_once == end;
            uint8_t* const display = shared && last ? shared->display : nullptr;
            cl::Event added;
            SideWork side_work;
            if (first) side_work.while_it_works = meanwhile;
            if (in_layers || sum || display || (show && last))
                side_work.behind = [&] {
                    cl::Event behind;
                    if (in_layers)
                        behind = added = im.film_kernels.add_layers(film, into, at_once, sample > 0, im.group_rows());
                    if (sum) behind = im.tracer->begin_count(im.film_kernels);
                    if (display) behind = im.begin_rows(settings, display);
                    if (show && last)
                        behind = im.relay.begin(im.film_of_colors(settings), settings, before == Impl::Shown::begun);
                    return behind;
                };
            const LaunchTimes times = im.launch(picture, sample, at_once, into, side_work);
            FrameStats one;
            one.kernels.push_back({"trace", times.device_ms});
            if (added()) one.kernels.push_back({"add samples", event_ms(added)});
            for (const KernelTime& kernel : one.kernels) one.device_ms += kernel.ms;
            one.wall_ms = times.wall_ms + one.device_ms - times.device_ms;
            one.launches = times.launches;
            one.primary = at_once * im.pixels();
            if (sum) im.end_sum(one);
            if (count_rays && im.counts_overflows()) one.overflowed = im.tracer->overflows(im.device->queue());
            sample += at_once;
            one.samples = sample;
            add_stats(stats, one);
            if (samples.complete && !samples.complete(sample) && sample < end) throw Cancelled();
        }
        im.device->loss()->note_worked();
        return stats;
    });
}

void FrameRenderer::count(FrameStats& stats) {
    Impl& im = *impl_;
    if (!im.program || im.rows.empty()) return;
    wrap_cl_errors(*im.device, "counting rays", [&] {
        if (im.counts_overflows()) stats.overflowed = im.tracer->overflows(im.device->queue());
        if (!im.tracer->counts_rays()) return;
        im.tracer->begin_count(im.film_kernels);
        im.end_sum(stats);
    });
}

FloatImage FrameRenderer::read_values() {
    FloatImage image = impl_->image(impl_->aov->value_channels());
    read_values(image);
    return image;
}

FloatImage FrameRenderer::read_picture(const Settings& settings) {
    Impl& im = *impl_;
    if (!denoises(settings)) return read_values();
    FloatImage image = im.image(3);
    wrap_cl_errors(*im.device, "reading the picture", [&] {
        const ColorFilm film = im.film_of_colors(settings);
        const size_t pixels = size_t(im.width) * im.height;
        im.scratch.resize(4 * pixels);
        im.read(film.sums, im.scratch.data(), 4 * pixels * sizeof(float));
        divide_sums(im.scratch.data(), image.pixels.data(), pixels);
    });
    return image;
}

void FrameRenderer::read_values(FloatImage& image) {
    Impl& im = *impl_;
    wrap_cl_errors(*im.device, "reading the film", [&] {
        if (im.aov->film == Aov::Film::statistics) return im.read_statistics(image);
        const bool color = im.aov->is_color();
        const size_t stored = size_t(im.width) * im.aov->film_channels();  // floats in a row of pixels
        if (color) im.scratch.resize(stored * im.height);
        float* const film = color ? im.scratch.data() : image.pixels.data();
        const std::vector<Band> bands = im.group_rows().bands();
        read_bands(im.device->queue(), im.film.get(), bands, stored * sizeof(float), film);
        finish(*im.device, im.device->queue(), "reading the film");
        parallel_for(static_cast<uint32_t>(bands.size()), [&](uint32_t b) {
            const Band& band = bands[b];
            const size_t begin = band.first * size_t(im.width), end = begin + band.count * size_t(im.width);
            if (color) {
                divide_sums(film + 4 * begin, image.pixels.data() + 3 * begin, end - begin);
            } else if (im.aov->film == Aov::Film::numbers) {
                for (size_t i = begin; i < end; ++i) {
                    rt_i32 number;
                    std::memcpy(&number, &film[i], sizeof number);
                    film[i] = static_cast<float>(number);
                }
            }
        });
    });
}

void FrameRenderer::read_sums(FloatImage& image) {
    Impl& im = *impl_;
    wrap_cl_errors(*im.device, "reading the film", [&] {
        for (unsigned plane = 0; plane < image.height / im.height; ++plane)
            read_bands(im.device->queue(), im.film.get(), im.in_plane(plane, im.group_rows().bands()), im.film_bytes(im.width),
                       image.pixels.data());
        finish(*im.device, im.device->queue(), "reading the film");
    });
}

void FrameRenderer::write_sums(const Prepared& prepared, const Settings& settings, const FloatImage& sums,
                               const SharedRows* shared) {
    Impl& im = *impl_;
    wrap_cl_errors(*im.device, "putting samples back", [&] {
        Progress never_cancelled;
        im.relay.forget_begun();
        im.begin({prepared, settings, View{}, shared, never_cancelled});
        const std::vector<rt_u32> rows(im.rows.begin() + std::ptrdiff_t(shared ? shared->begin : 0), im.rows.end());
        const size_t row_bytes = im.film_bytes(im.width);
        const GroupRows written{im.width, im.height, im.layout.row_height(), rows};
        const std::vector<Band> bands = written.bands();
        if (im.planes() > 1) im.count_resting(sums, written);
        for (unsigned plane = 0; plane < im.planes(); ++plane)
            for (const Band& band : im.in_plane(plane, bands))
                im.device->queue().enqueueWriteBuffer(
                    im.film.get(), CL_FALSE, band.first * row_bytes, band.count * row_bytes,
                    reinterpret_cast<const char*>(sums.pixels.data()) + band.first * row_bytes);
        finish(*im.device, im.device->queue(), "putting samples back");
    });
}

FloatImage FrameRenderer::read_distance() {
    FloatImage image = impl_->image(1);
    return read_distance(image) ? image : FloatImage{};
}

bool FrameRenderer::read_distance(FloatImage& image) {
    Impl& im = *impl_;
    if (im.aov->film == Aov::Film::distances) {
        read_values(image);
        return true;
    }
    if (!im.program || !im.tracer->counts_rays()) return false;
    wrap_cl_errors(*im.device, "reading distances", [&] {
        im.scratch.resize(size_t(im.groups()) * im.layout.group_packets() * im.layout.rays());
        if (!im.scratch.empty()) im.read(im.distances.get(), im.scratch.data(), im.scratch.size() * sizeof(float));
        put_in_order(im.layout, im.rows, im.scratch.data(), image);
    });
    return true;
}

void FrameRenderer::read_display(const Settings& settings, uint8_t* rgba, std::vector<KernelTime>& times) {
    Impl& im = *impl_;
    if (im.rows.empty()) return;
    wrap_cl_errors(*im.device, "reading the picture", [&] {
        im.begin_rows(settings, rgba);
        im.film_kernels.end_rows(times);
    });
}

void FrameRenderer::add_display_times(std::vector<KernelTime>& times) {
    wrap_cl_errors(*impl_->device, "reading the picture", [&] { impl_->film_kernels.end_rows(times); });
}

ByteImage FrameRenderer::read_display(const Settings& settings, FrameStats* stats, FalseColorScale* scale) {
    Impl& im = *impl_;
    if (scale) *scale = {};
    if (!im.aov->is_color())
        return show_values([this] { return read_values(); }, im.aov->name, settings, stats ? &stats->kernels : nullptr, scale);
    im.shown = Impl::Shown::read;
    return wrap_cl_errors(*im.device, "reading the picture",
                          [&] { return im.relay.take([&] { return im.film_of_colors(settings); }, settings, false); })
        .wait(stats ? &stats->kernels : nullptr);
}

AsyncReadback FrameRenderer::begin_display(const Settings& settings) {
    Impl& im = *impl_;
    im.shown = Impl::Shown::begun;
    return wrap_cl_errors(*im.device, "reading the picture",
                          [&] { return im.relay.take([&] { return im.film_of_colors(settings); }, settings, true); });
}

bool FrameRenderer::overlaps_copies() const {
    return impl_->program && impl_->aov->is_color() && !impl_->device->info().cpu;
}

}  // namespace clarity
