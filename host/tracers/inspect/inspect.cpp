#include "tracers/inspect/inspect.hpp"

#include <algorithm>
#include <cstring>

#include "device/cl_errors.hpp"
#include "device/launch_limit.hpp"
#include "launch/frame_constants.hpp"
#include "launch/view_buffers.hpp"
#include "picture/overflow_counter.hpp"
#include "tracers/iterative/iterative.hpp"
#include "tracers/smoke.hpp"
#include "trial/trial.hpp"

namespace clarity {
namespace {

constexpr cl_uint kMostRecords = 4096;  // 400 kB; a pixel of a typical picture has fewer than 100
constexpr unsigned kSummaryWords = 5;   // as inspect.cl writes them

std::array<float, 3> three(const rt_f32* v) {
    return {v[0], v[1], v[2]};
}

RayRecord record_of(const rt_ray_record& r) {
    RayRecord record;
    record.kind = static_cast<RayRecord::Kind>(r.kind);
    record.fate = static_cast<RayRecord::Fate>(r.fate);
    record.parent = r.parent;
    record.generation = r.generation;
    record.origin = three(r.origin);
    record.direction = three(r.direction);
    record.t = r.t;
    record.weight = three(r.weight);
    record.light = three(r.light);
    record.prim = r.prim;
    record.instance = r.instance;
    record.material = r.material;
    record.light_index = r.light_index;
    record.occluded = r.occluded != 0;
    record.steps = r.steps;
    record.leaf_tests = r.leaf_tests;
    return record;
}

// The packet's rays are those of the tracer `iterative`.
const KernelRow& kernel_row() {
    static const KernelRow row = [] {
        KernelRow r;
        r.tracer = "inspect";
        r.what = "inspector";
        r.file = "tracers/inspect/inspect.cl";
        r.entry = "trace_inspect";
        r.headers = headers_by_generations(true);
        r.defines = {"RT_INSPECT", "RT_COUNT_STEPS"};
        r.define = define_ray_slots;
        return r;
    }();
    return row;
}

void smoke_pixels(const Smoke& smoke) {
    constexpr const char* what = "recorded the rays of some pixels";
    const Settings& settings = smoke.prepared.settings;
    double limit_s = compile_first(smoke, kernel_row());
    Inspector inspector(smoke.device);
    for (unsigned y = 4; y < unsigned(settings.height); y += 8)
        for (unsigned x = 4; x < unsigned(settings.width); x += 8) {
            smoke.say_step(std::string("they ") + what, limit_s);
            limit_s = kRunLimit_s;
            expect_room_on_stacks(inspector.trace(smoke.prepared, settings, smoke.view, x, y).overflowed, what);
        }
}

}  // namespace

static_assert(sizeof(rt_ray_record) == 96);
static_assert(RT_RAY_SHADOW == static_cast<rt_u32>(RayRecord::Kind::shadow) &&
              RT_FATE_UNASKED == static_cast<rt_u32>(RayRecord::Fate::unasked));

struct Inspector::Impl {
    explicit Impl(std::shared_ptr<Device> d)
        : device(std::move(d)), programs(device), queue(device->context(), device->info().cl_device) {}

    std::shared_ptr<Device> device;
    ProgramCache programs;
    Queue queue;  // its own, so that frames continue in the device's queue
    ViewBuffers view;
    GrowingBuffer records{CL_MEM_READ_WRITE}, summary{CL_MEM_WRITE_ONLY}, distances{CL_MEM_READ_WRITE};
};

Inspector::Inspector(std::shared_ptr<Device> device) {
    wrap_cl_errors(*device, "preparing the inspector", [&] { impl_ = std::make_unique<Impl>(device); });
}
Inspector::~Inspector() {
    if (impl_ && impl_->device->loss()->stuck()) never_release(std::shared_ptr<Impl>(std::move(impl_)));
}

RayTree Inspector::trace(const Prepared& prepared, const Settings& settings, const View& view, unsigned x, unsigned y) {
    Impl& im = *impl_;
    check_pixel(settings, x, y);
    const Layout& layout = prepared.layout;
    Progress never_cancelled;
    const auto program = tried_program(im.programs, prepared, kernel_row(), never_cancelled);
    return wrap_cl_errors(*im.device, "inspecting a pixel", [&] {
        const cl::Context& context = im.device->context();
        im.view.write(im.queue, *prepared.scene, *prepared.on_device, {make_frame(view, settings, layout, *prepared.accel, 0)},
                      view);
        const cl::Buffer& records = im.records.fit(context, kMostRecords * sizeof(rt_ray_record));
        const cl::Buffer& summary = im.summary.fit(context, kSummaryWords * sizeof(rt_u32));
        const PixelPlace place = layout.place_of(x, y, static_cast<unsigned>(settings.width));
        KernelArguments kernel = program->kernel();
        kernel.set("group", cl_uint(place.group))
            .set("packet_wanted", cl_uint(place.packet))
            .set("pixel", cl_uint(place.pixel));
        kernel.set("records", records).set("capacity", kMostRecords).set("summary", summary);
        kernel.set("distances", im.distances.fit(context, layout.rays() * sizeof(float)));
        im.view.bind(*prepared.on_device, kernel);
        const size_t items = layout.local_size();
        im.queue.enqueueNDRangeKernel(kernel.kernel(), cl::NullRange, cl::NDRange(items), cl::NDRange(items));
        finish(*im.device, im.queue, "following the rays of a pixel");

        rt_u32 found[kSummaryWords] = {};
        im.queue.enqueueReadBuffer(summary, CL_TRUE, 0, sizeof found, found);
        std::vector<rt_ray_record> read(std::min<size_t>(found[0], kMostRecords));
        if (!read.empty()) im.queue.enqueueReadBuffer(records, CL_TRUE, 0, read.size() * sizeof(rt_ray_record), read.data());
        RayTree tree;
        tree.truncated = found[0] > kMostRecords;
        std::memcpy(tree.color.data(), found + 1, sizeof tree.color);
        tree.overflowed = found[4];
        report_overflows(tree.overflowed, prepared.accel->plugin->id);
        for (const rt_ray_record& record : read) tree.rays.push_back(record_of(record));
        return tree;
    });
}

const Tracer& inspect_tracer() {
    static const Tracer tracer = tracer_with("inspect", smoke_pixels);
    return tracer;
}

}  // namespace clarity
