#include "ui/threads/preview_thread.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <map>

#include "base/angle.hpp"
#include "base/error.hpp"
#include "launch/prepared.hpp"
#include "scene/light_kinds.hpp"
#include "scene/scene.hpp"
#include "scene/tangents.hpp"
#include "stand/triangle_mesh.hpp"
#include "ui/threads/thread_priority.hpp"
#include "view/settings/accel_choice.hpp"
#include "view/view.hpp"

namespace clarity::ui {
namespace {

// A ball of one material on a chequered floor, under a soft sky and a lamp.
inline constexpr rt_u32 kPreviewMaterial = 1;  // its number in the scene

constexpr rt_u32 kMostTexels = 512;  // along a side of a texture

// A unit ball on the floor, of triangles: spheres have no tangents. A texture goes around it twice, so that it is not
// stretched.
TriangleMesh unit_ball() {
    constexpr rt_u32 kAround = 64, kUp = 32;
    TriangleMesh mesh;
    mesh.add_grid({kUp, kAround, kCut013, false, false, true, true}, [&](rt_u32 j, rt_u32 i) {
        const double up = double(j) / kUp, around = double(i) / kAround, theta = kPi * (up - 0.5), phi = 2 * kPi * around;
        const Vec n{std::cos(theta) * std::sin(phi), std::sin(theta), std::cos(theta) * std::cos(phi)};
        mesh.add_vertex(n + Vec{0, 1, 0}, n, 2 * around, up);
    });
    return mesh;
}

// Copies textures of another scene, each once.
class Textures {
 public:
    Textures(const Scene& from, Scene& to) : from_(from), to_(to) {}
    rt_u32 copy(rt_u32 texture) {
        if (texture == RT_NONE) return RT_NONE;
        const auto [known, is_new] = copies_.emplace(texture, static_cast<rt_u32>(to_.textures.size()));
        if (!is_new) return known->second;
        rt_texture picture = from_.textures[texture];
        while (picture.levels > 0 && std::max(picture.width, picture.height) > kMostTexels) picture = smaller_picture(picture);
        const uint32_t* const texels = from_.texels.data() + picture.first;
        const auto count = static_cast<std::ptrdiff_t>(texel_count(picture));
        picture.first = static_cast<rt_u32>(to_.texels.size());
        to_.texels.append(texels, texels + count);
        to_.textures.push_back(picture);
        return known->second;
    }

 private:
    const Scene& from_;
    Scene& to_;
    std::map<rt_u32, rt_u32> copies_;
};

rt_light lamp() {
    rt_light light = default_light(RT_LIGHT_RECT);
    const float center[3] = {-2.5f, 4.5f, 2.5f}, u[3] = {0.7f, 0.5f, 0}, v[3] = {0.25f, -0.35f, 0.74f};
    std::copy_n(center, 3, light.position);
    std::copy_n(u, 3, light.u);
    std::copy_n(v, 3, light.v);
    std::fill_n(light.color, 3, 14.0f);
    make_sound(light);
    return light;
}

void set_colors(rt_f32 (&to)[3], float r, float g, float b) {
    to[0] = r, to[1] = g, to[2] = b;
}

// of: the scene that has the material. Of its textures only those of the material are copied, from their first picture that is
// small enough on.
Scene preview_scene(const Scene& of, rt_u32 number) {
    Scene scene;
    Material floor;
    floor.values = default_material();
    floor.values.model = RT_MODEL_LAMBERT;
    floor.values.flags |= RT_MATERIAL_CHECKER;
    set_colors(floor.values.color, 0.5f, 0.5f, 0.5f);
    Material material = of.materials[number];
    Textures textures(of, scene);
    material.values.texture = textures.copy(material.values.texture);
    for (rt_u32& map : material.maps) {
        if (map == RT_NONE) continue;
        rt_map own = of.maps[map];
        own.texture = textures.copy(own.texture);
        own.set = 0;  // the ball has one set of coordinates
        map = static_cast<rt_u32>(scene.maps.size());
        scene.maps.push_back(own);
    }
    scene.materials = {Material{"", default_material()}, material, floor};
    place(scene, add_mesh(scene, unit_ball(), kPreviewMaterial, "ball"));
    make_tangents(scene);
    scene.planes.push_back({{0, 1, 0}, 0, 2});
    scene.lights.push_back({"lamp", lamp()});
    scene.sky.values.kind = RT_SKY_GRADIENT;
    set_colors(scene.sky.values.color, 0.35f, 0.45f, 0.6f);
    set_colors(scene.sky.values.horizon, 0.8f, 0.8f, 0.8f);
    set_colors(scene.sky.values.ground, 0.2f, 0.2f, 0.2f);
    Camera camera;
    camera.eye = {0, 1.9f, 4.6f};
    camera.target = {0, 0.92f, 0};
    camera.fov_y_rad = static_cast<float>(29 * kRadPerDegree);
    scene.cameras.push_back(camera);
    return scene;
}

constexpr unsigned kSamples = 64;
constexpr const char* kAccel = "bvh2";
constexpr auto kWaitWhileBusy = std::chrono::milliseconds(250);

bool same_values(const MaterialValues& a, const MaterialValues& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

bool is_power_of_two(unsigned n) {
    return (n & (n - 1)) == 0;
}

// The same picture while that of newer numbers is awaited.
std::shared_ptr<const Preview> not_done(Preview preview) {
    preview.done = false;
    return std::make_shared<const Preview>(std::move(preview));
}

}  // namespace

PreviewThread::Ball::Ball(const PreviewJob& job)
    : loaded(job.ready->loaded), maps(job.ready->request.maps), material(job.material) {}

bool PreviewThread::Ball::operator==(const Ball& b) const {
    const auto scene = loaded.lock();
    return scene && scene == b.loaded.lock() && maps == b.maps && material == b.material;
}

// Whether the picture of one serves for the other.
bool PreviewThread::is_same(const PreviewJob& a, const PreviewJob& b) {
    return Ball(a) == Ball(b) && a.size == b.size && same_values(a.values, b.values) && !a.ready->main.loan->withdrawn() &&
           a.ready->main.devices_text() == b.ready->main.devices_text() &&
           a.ready->request.kernel_revision == b.ready->request.kernel_revision;
}

PreviewThread::PreviewThread(const PluginRegistry& plugins, std::function<void()> wake)
    : plugins_(plugins), wake_(std::move(wake)), thread_([this] { run(); }) {}

PreviewThread::~PreviewThread() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        stop_ = true;
        if (progress_) progress_->cancel();
    }
    changed_.notify_all();
    thread_.join();
}

void PreviewThread::show(const PreviewJob& job) {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        const bool is_known = job_ && is_same(*job_, job);
        if (is_known) job_->ready = job.ready;  // a newer pose
        if (is_known) return;
        // What is being compiled goes on: kernels serve other balls, too, and whoever clicks around would never see one.
        if (!job_ || !(Ball(*job_) == Ball(job)) || (latest_ && !latest_->failure.empty())) latest_.reset();
        if (latest_ && latest_->done) latest_ = not_done(*latest_);
        job_ = job;
        begun_.reset();
    }
    changed_.notify_all();
}

void PreviewThread::hide() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!job_) return;
    if (progress_) progress_->cancel();
    job_.reset();
    latest_.reset();
    begun_.reset();
}

void PreviewThread::set_busy(bool busy) {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (busy_ == busy) return;
        busy_ = busy;
    }
    changed_.notify_all();
}

std::shared_ptr<const Preview> PreviewThread::latest() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return latest_;
}

void PreviewThread::release() {
    std::unique_lock<std::mutex> lock(mutex_);
    released_ = true;
    if (progress_) progress_->cancel();
    stopped_.wait(lock, [this] { return !running_; });
    tracer_ = {};
}

void PreviewThread::resume() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        released_ = false;
    }
    changed_.notify_all();
}

void PreviewThread::run() {
    yield_to_window();
    const auto wants_work = [this] { return stop_ || (!released_ && job_ && !(begun_ && begun_->done)); };
    for (;;) {
        PreviewJob job;
        std::shared_ptr<Progress> progress;
        auto preview = std::make_shared<Preview>();
        {
            std::unique_lock<std::mutex> lock(mutex_);
            running_ = false;
            progress_.reset();
            stopped_.notify_all();
            changed_.wait(lock, wants_work);
            if (!stop_ && busy_) changed_.wait_for(lock, kWaitWhileBusy, [this] { return stop_ || released_ || !busy_; });
            if (stop_) return;
            if (!wants_work()) continue;
            job = *job_;
            if (begun_) *preview = *begun_;
            progress = progress_ = std::make_shared<Progress>();
            running_ = true;
        }
        preview->material = job.material;
        try {
            trace(job, preview->samples, *preview, *progress);
        } catch (const Cancelled&) {
            continue;
        } catch (const std::exception& error) {
            preview->failure = error.what();
        }
        preview->done = !preview->failure.empty() || preview->samples >= kSamples;
        const Ball ball(job);
        const bool lost_device = job.ready->main.loan->withdrawn();  // then another job follows
        job.ready.reset();                                           // here, and not under the lock
        bool is_news = false;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            // A sample of numbers that have changed since is shown, but not added to.
            if (progress->cancelled() || !job_ || !(Ball(*job_) == ball)) continue;
            const bool is_current = same_values(job_->values, job.values) && job_->size == job.size;
            if (is_current) begun_ = preview;
            is_news = preview->done || is_power_of_two(preview->samples);
            if (is_news) latest_ = is_current && !lost_device ? preview : not_done(*preview);
        }
        if (is_news) wake_();
    }
}

void PreviewThread::prepare(const PreviewJob& job, const View& view, Progress& progress) {
    Settings settings = tracer_.prepared ? tracer_.prepared->first()->settings : Settings();
    settings.width = settings.height = static_cast<int>(job.size);
    settings.tracer = "path";
    settings.depth = 12;
    // What compiles fast: few rays are traced.
    settings.lanes = 1;
    if (settings.accel.empty())
        choose_accel(plugins_, plugins_.accel(kAccel) ? kAccel : plugins_.accels().front()->id, settings);
    settings.optics = settings.optics | optics_of(*scene_, view, settings);
    tracer_.prepared = tracer_.preparer->prepare(scene_, settings, progress);
    kernel_revision_ = job.ready->request.kernel_revision;
}

void PreviewThread::trace(const PreviewJob& job, unsigned sample, Preview& preview, Progress& progress) {
    const std::shared_ptr<const OnDevices> lent = job.ready->main.loan->get();
    if (!lent) throw Error(Exit::no_device, "the device is being opened anew");  // another job follows
    const std::shared_ptr<Device>& device = lent->prepared->parts.front().device;
    if (tracer_.of != device) {
        tracer_ = {};
        tracer_.of = device;
        tracer_.device = device->with_own_queue();
        tracer_.preparer = std::make_unique<MultiPreparer>(plugins_, Devices{tracer_.device});
        tracer_.frames = std::make_unique<MultiFrameRenderer>(Devices{tracer_.device});
    }
    if (!scene_ || !(scene_of_ == Ball(job))) {
        scene_ = std::make_shared<const Scene>(preview_scene(*job.ready->scene, job.material));
        scene_of_ = Ball(job);
    }
    View view = make_view(*scene_, 1);
    for (const Material& material : scene_->materials) view.materials.push_back(material.values);
    const rt_u32 texture = view.materials[kPreviewMaterial].texture;
    view.materials[kPreviewMaterial] = job.values;
    view.materials[kPreviewMaterial].texture = texture;
    const std::shared_ptr<const MultiPrepared>& prepared = tracer_.prepared;
    if (!prepared || prepared->first()->scene != scene_ || kernel_revision_ != job.ready->request.kernel_revision ||
        !prepared->first()->knows(view))
        prepare(job, view, progress);
    Settings settings = prepared->first()->settings;
    settings.width = settings.height = static_cast<int>(job.size);
    settings.spp = kSamples;
    tracer_.frames->trace(prepared, settings, view, sample, false, progress);
    preview.samples = sample + 1;
    if (is_power_of_two(preview.samples) || preview.samples == kSamples) preview.image = tracer_.frames->read_display(settings);
}

}  // namespace clarity::ui
