#include "tracers/replay/replay.hpp"

#include <algorithm>

#include "base/numbers.hpp"
#include "device/cl_errors.hpp"
#include "device/launch_limit.hpp"
#include "launch/frame_constants.hpp"
#include "launch/view_buffers.hpp"
#include "tracers/path/path.hpp"
#include "tracers/smoke.hpp"
#include "trial/trial.hpp"

namespace clarity {
namespace {

// Of one launch. A launch cannot be cancelled.
constexpr size_t kRecordBytes = size_t(32) << 20;
constexpr unsigned kMostAtOnce = 1024;

const KernelRow& replay_row() {
    static const KernelRow row = [] {
        KernelRow r;
        r.tracer = "replay";
        r.what = "replay of paths";
        r.file = "tracers/replay/replay.cl";
        r.entry = "replay_samples";
        r.headers =
            path_headers({"tracers/inspect/one_lane.h", "tracers/replay/path_record.h", "tracers/replay/path_recorder.h"});
        r.defines = {"RT_INSPECT"};
        r.traits = kPicksLights;
        return r;
    }();
    return row;
}

void smoke_replay(const Smoke& smoke) {
    const double limit_s = compile_first(smoke, replay_row());
    smoke.say_step("they recorded the paths of a pixel", limit_s);
    Replay replay;
    Progress never_cancelled;
    const auto middle = [](int size) { return static_cast<unsigned>(size) / 2; };
    const Settings& settings = smoke.prepared.settings;
    PathReplayer(smoke.device)
        .trace(smoke.prepared, settings, smoke.view, middle(settings.width), middle(settings.height), 16, never_cancelled,
               replay);
}

}  // namespace

static_assert(sizeof(rt_path_record) == 80);

struct PathReplayer::Impl {
    explicit Impl(std::shared_ptr<Device> d)
        : device(std::move(d)), programs(device), queue(device->context(), device->info().cl_device) {}

    std::shared_ptr<Device> device;
    ProgramCache programs;
    Queue queue;  // its own, so that frames continue in the device's queue
    ViewBuffers view;
    GrowingBuffer records{CL_MEM_WRITE_ONLY}, counts{CL_MEM_WRITE_ONLY}, lights{CL_MEM_READ_WRITE},
        distances{CL_MEM_READ_WRITE}, film{CL_MEM_READ_WRITE};

    // Adds samples [first, first + count) of those that one launch traces.
    void launch(const TraceProgram& program, const Prepared& prepared, const Settings& settings, const View& of_frame,
                unsigned x, unsigned y, unsigned first, unsigned count, Replay& replay) {
        const cl::Context& context = device->context();
        const cl_uint capacity = RT_MOST_PATH_RECORDS(static_cast<cl_uint>(settings.depth));
        rt_frame frame = make_frame(of_frame, settings, prepared.layout, *prepared.accel, first);
        frame.samples = count;
        view.write(queue, *prepared.scene, *prepared.on_device, {frame}, of_frame);
        view.write_emitters(queue, *prepared.scene, prepared.accel, of_frame, prepared.settings,
                            prepared.is_moved ? prepared.on_device.get() : nullptr);
        KernelArguments kernel = program.kernel();
        kernel.set("x", cl_uint(x)).set("y", cl_uint(y)).set("capacity", capacity);
        kernel.set("records", records.fit(context, size_t(count) * capacity * sizeof(rt_path_record)));
        kernel.set("counts", counts.fit(context, count * sizeof(cl_uint)));
        kernel.set("lights", lights.fit(context, count * sizeof(cl_float4)));
        kernel.set("distances", distances.fit(context, prepared.layout.rays() * sizeof(float)));
        view.bind(*prepared.on_device, kernel);
        const size_t local = prepared.layout.local_size(), lanes = prepared.layout.lanes;
        const size_t items = ((count + lanes - 1) / lanes + local - 1) / local * local;
        queue.enqueueNDRangeKernel(kernel.kernel(), cl::NullRange, cl::NDRange(items), cl::NDRange(local));
        KernelArguments sum = program.kernel("sum_samples");
        sum.set("lights", lights.get()).set("samples", cl_uint(count)).set("adds", cl_uint(first > 0));
        sum.set("film", film.fit(context, 2 * sizeof(cl_float4)));
        queue.enqueueNDRangeKernel(sum.kernel(), cl::NullRange, cl::NDRange(1), cl::NDRange(1));
        finish(*device, queue, "tracing the samples of a pixel once more");
        read(first, count, capacity, replay);
    }

    SamplerPoints draw(const TraceProgram& program, const Prepared& prepared, const Settings& settings, const View& of_frame,
                       unsigned x, unsigned y, unsigned count, unsigned events) {
        const cl_uint sets = 1 + 2 * events;
        SamplerPoints points{count, 4 * sets, std::vector<float>(size_t(count) * 4 * sets)};
        rt_frame frame = make_frame(of_frame, settings, prepared.layout, *prepared.accel, 0);
        frame.samples = count;
        view.write(queue, *prepared.scene, *prepared.on_device, {frame}, of_frame);
        KernelArguments kernel = program.kernel("draw_numbers");
        kernel.set("frame", view.frame()).set("x", cl_uint(x)).set("y", cl_uint(y)).set("sets", sets);
        kernel.set("numbers", records.fit(device->context(), points.values.size() * sizeof(float)));
        const size_t local = prepared.layout.local_size(), lanes = prepared.layout.lanes;
        const size_t items = ((count + lanes - 1) / lanes + local - 1) / local * local;
        queue.enqueueNDRangeKernel(kernel.kernel(), cl::NullRange, cl::NDRange(items), cl::NDRange(local));
        queue.enqueueReadBuffer(records.get(), CL_TRUE, 0, points.values.size() * sizeof(float), points.values.data());
        return points;
    }

    void read(unsigned first, unsigned count, cl_uint capacity, Replay& replay) {
        std::vector<cl_uint> of_sample(count);
        std::vector<cl_float4> light(count);
        std::vector<rt_path_record> all(size_t(count) * capacity);
        queue.enqueueReadBuffer(counts.get(), CL_TRUE, 0, count * sizeof(cl_uint), of_sample.data());
        queue.enqueueReadBuffer(lights.get(), CL_TRUE, 0, count * sizeof(cl_float4), light.data());
        queue.enqueueReadBuffer(records.get(), CL_TRUE, 0, all.size() * sizeof(rt_path_record), all.data());
        cl_float4 sums;
        queue.enqueueReadBuffer(film.get(), CL_TRUE, 0, sizeof sums, &sums);
        for (unsigned s = 0; s < count; ++s) {
            const unsigned found = std::min(of_sample[s], capacity);
            replay.samples.push_back({{light[s].s[0], light[s].s[1], light[s].s[2]}, replay.records.size(), found});
            const auto begin = all.begin() + std::ptrdiff_t(size_t(s) * capacity);
            replay.records.insert(replay.records.end(), begin, begin + found);
        }
        for (int k = 0; k < 3; ++k) replay.mean[k] = sums.s[k] / static_cast<float>(first + count);
    }
};

PathReplayer::PathReplayer(std::shared_ptr<Device> device) {
    wrap_cl_errors(*device, "preparing the replay of a pixel", [&] { impl_ = std::make_unique<Impl>(device); });
}
PathReplayer::~PathReplayer() {
    if (impl_ && impl_->device->loss()->stuck()) never_release(std::shared_ptr<Impl>(std::move(impl_)));
}

void PathReplayer::trace(const Prepared& prepared, const Settings& settings, const View& view, unsigned x, unsigned y,
                         unsigned count, Progress& progress, Replay& replay) {
    Impl& im = *impl_;
    check_pixel(settings, x, y);
    prepared.expect_known(view);
    const auto program = tried_program(im.programs, prepared, replay_row(), progress);
    const auto first = static_cast<unsigned>(replay.samples.size());
    const size_t of_sample = RT_MOST_PATH_RECORDS(size_t(settings.depth)) * sizeof(rt_path_record);
    const auto most = static_cast<unsigned>(std::min<size_t>(kMostAtOnce, kRecordBytes / of_sample));
    wrap_cl_errors(*im.device, "tracing the samples of a pixel once more", [&] {
        for (unsigned done = 0; done < count;) {
            if (!progress.report(float(done) / float(count))) throw Cancelled();
            const unsigned next = std::min(count - done, most);
            im.launch(*program, prepared, settings, view, x, y, first + done, next, replay);
            done += next;
        }
    });
}

SamplerPoints PathReplayer::points(const Prepared& prepared, const Settings& settings, const View& view, unsigned x, unsigned y,
                                   unsigned count, unsigned events, Progress& progress) {
    Impl& im = *impl_;
    check_pixel(settings, x, y);
    prepared.expect_known(view);
    const auto program = tried_program(im.programs, prepared, replay_row(), progress);
    return wrap_cl_errors(*im.device, "drawing the random numbers of a pixel",
                          [&] { return im.draw(*program, prepared, settings, view, x, y, count, events); });
}

const Tracer& replay_tracer() {
    static const Tracer tracer = tracer_with("replay", smoke_replay);
    return tracer;
}

std::string dimension_name(unsigned dimension) {
    static const char* const of_camera[] = {"pixel x", "pixel y", "lens u", "lens v"};
    static const char* const of_event[] = {"lobe",       "direction u", "direction v", "roulette",
                                           "light pick", "light u",     "light v",     "light tree"};
    if (dimension < 4) return of_camera[dimension];
    return "event " + std::to_string((dimension - 4) / 8 + 1) + " " + of_event[(dimension - 4) % 8];
}

Strata strata_of(const SamplerPoints& points, unsigned across, unsigned up) {
    Strata strata;
    while (2 * strata.columns * strata.rows <= points.samples)
        (strata.columns <= strata.rows ? strata.columns : strata.rows) *= 2;
    std::vector<bool> filled(size_t(strata.columns) * strata.rows);
    const auto cell = [](float at, unsigned count) {
        return std::min(count - 1, static_cast<unsigned>(at * static_cast<float>(count)));
    };
    for (unsigned s = 0; s < points.samples; ++s)
        filled[size_t(cell(points.at(s, up), strata.rows)) * strata.columns + cell(points.at(s, across), strata.columns)] =
            true;
    strata.filled = static_cast<unsigned>(std::count(filled.begin(), filled.end(), true));
    return strata;
}

std::string points_csv(const SamplerPoints& points) {
    std::string text = "sample";
    for (unsigned d = 0; d < points.dimensions; ++d) text += "," + dimension_name(d);
    text += "\n";
    for (unsigned s = 0; s < points.samples; ++s) {
        text += std::to_string(s);
        for (unsigned d = 0; d < points.dimensions; ++d) text += "," + exact_text(points.at(s, d));
        text += "\n";
    }
    return text;
}

}  // namespace clarity
