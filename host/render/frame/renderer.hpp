// renderer.hpp -- from a scene and settings to a picture.
//
// Rendering has two steps. Preparer::prepare() does the slow work (build, upload, compile) and returns an immutable Prepared.
// It may run on any thread while frames continue with the previous Prepared. FrameRenderer::trace() then traces samples of one
// frame with a Prepared. Two results of prepare() share everything that did not change between the calls.
#pragma once
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "device/device.hpp"
#include "plugin/registry.hpp"
#include "render/accel/accel_build.hpp"
#include "render/film/async_readback.hpp"
#include "render/film/false_colors.hpp"
#include "render/film/image_io.hpp"
#include "render/kernels/layout.hpp"
#include "render/settings/settings.hpp"
#include "scene/scene.hpp"

namespace clarity {

class DeviceScene;   // the buffers of one scene in one structure
class TraceProgram;  // the compiled kernels of one specialisation
class ProgramCache;
class RayBlocks;  // rays in the layout that kernels read: ray_blocks.hpp

// Everything that kernels need to trace a scene. Immutable. It keeps its device open and the scene's buffers on it allocated:
// see Preparer::close_device().
struct Prepared {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const AccelData> accel;
    std::shared_ptr<const DeviceScene> on_device;
    std::shared_ptr<const TraceProgram> program;
    Settings settings;                     // as asked for; what was automatic is resolved
    Layout layout;                         // follows from these settings on this device
    double compile_ms = 0, upload_ms = 0;  // 0 if the result is shared with an earlier Prepared
    bool compile_cached = false;           // the program was compiled for an earlier Prepared
};

// Makes Prepared objects for one device. Thread-safe; each object runs one prepare() at a time.
class Preparer {
 public:
    Preparer(const PluginRegistry& plugins, std::shared_ptr<Device> device);
    ~Preparer();
    // Builds, uploads and compiles what has changed since the last call, and returns the result.
    // built: the result of build() for these settings, possibly made for another device. Without it, prepare() builds.
    // Throws Error(failed) if the build or the upload fails, Error(kernel_build_failed) with the compiler's log in details(),
    // Error(usage) for an unknown structure, and Cancelled. The previous Prepared stays valid.
    std::shared_ptr<const Prepared> prepare(std::shared_ptr<const Scene> scene, const Settings& settings, Progress& progress,
                                            std::shared_ptr<const AccelData> built = nullptr);
    // Builds the structure alone. This needs no device.
    std::shared_ptr<const AccelData> build(const std::shared_ptr<const Scene>& scene, const Settings& settings,
                                           Progress& progress);
    // Whether the caller should close the device and open it again. PoCL keeps at least 0.15 MB for each program that it has
    // compiled, and frees it only with the last context of the process. Editing kernels compiles hundreds of programs.
    bool needs_reopen() const;
    // Releases the device with all programs and buffers on it, and keeps the last structure. The device closes as soon as the
    // caller has also released its Device, every Prepared, and every FrameRenderer and Inspector. Returns the info to open a
    // new Device with. Until open_device(), prepare() throws Error(no_device).
    DeviceInfo close_device();
    void open_device(std::shared_ptr<Device> device);

 private:
    // settings: of a structure that is there.
    std::shared_ptr<const AccelData> build_or_last(const std::shared_ptr<const Scene>& scene, const Settings& settings,
                                                   Progress& progress);
    const PluginRegistry& plugins_;
    const DeviceInfo info_;
    std::shared_ptr<Device> device_;          // nullptr: closed
    std::unique_ptr<ProgramCache> programs_;  // nullptr: closed
    std::shared_ptr<const Prepared> last_;    // without buffers and program after close_device()
    mutable std::mutex mutex_;
};

// The camera, lights, materials and background of a frame. They may change from frame to frame without a new prepare().
struct View {
    Camera camera;
    std::vector<rt_light> lights;
    std::vector<rt_material> materials;  // one for each material of the scene; empty: use the scene's own
    std::array<float, 3> background{}, ambient{};
};
// Makes a view from the scene's camera, lights, ambient light and background. If the scene has no lights, it gets two that suit
// its size.
// camera: "" (the scene's first camera, or one that frames the scene), a camera's name, or "ex,ey,ez,tx,ty,tz[,fov_deg]".
// light: "" or "x,y,z", which moves the first light and makes it a point light. Throws Error(usage) if it cannot read either.
View make_view(const Scene& scene, float aspect, const std::string& camera = {}, const std::string& light = {});

// The time of one step of a frame's work, measured by the device's clock.
struct KernelTime {
    std::string name;
    double ms = 0;
};

// One device's part in a picture that several devices share.
struct DeviceShare {
    std::string id, name;
    double share = 0;                     // of the picture's rows, 0 to 1
    double device_ms = 0, wall_ms = 0;    // tracing, by the device's clock and by the clock of its host thread
    double tone_map_ms = 0, read_ms = 0;  // read_display(), by the device's clock
    unsigned launches = 0;
};

// Times and ray counts of the samples that one call has traced.
struct FrameStats {
    double device_ms = 0;  // kernels of these samples, by the device's clock
    double wall_ms = 0;    // the same by the host's clock, including waiting
    uint64_t primary = 0, shadow = 0, secondary = 0,
             dropped = 0;     // rays of these samples; all but primary are 0 unless counted
    uint64_t overflowed = 0;  // traversal stacks that were full (debug programs only)
    unsigned samples = 0;     // in the film now
    unsigned launches = 0;    // launches that traced these samples
    // The steps: trace, counters, adding samples. read_display() appends tone mapping and read-back.
    std::vector<KernelTime> kernels;
    // One for each device if several share the picture. The times above are then those of the slowest device.
    std::vector<DeviceShare> devices;
};

// The rows of work-groups that one device traces of a shared picture, in the order in which the scheduler assigned them. A
// sample may take several calls while rows are assigned. Rows before `begin` are already traced.
struct SharedRows {
    std::vector<rt_u32> rows;
    size_t begin = 0;
    // If set, trace() copies the displayed rows to this picture behind the last sample, as read_display() does.
    uint8_t* display = nullptr;
};

// What trace_rays() computes.
struct RayQuery {
    bool any_hit = false;  // only whether anything is hit between t_min and t_max
    // Fill in steps, leaf_tests and lane_steps. This uses a slower program: leave it out when measuring time.
    bool count = false;
    // Write only t and prim of the nearest hit. Use it to compare times with libraries that write no more than that.
    bool brief = false;
};

// How the last trace_rays() ran. The autotuner (autotuner.hpp) tries several variants for each set of rays.
struct RayTuning {
    unsigned way = 0;     // number of the variant; 0 is the plain kernel
    bool trial = false;   // this run tried a variant that may be slow: do not use its time as a measurement
    bool settled = true;  // the variant is chosen, and one more run has confirmed the choice
};

// Consecutive samples of a picture. Sample 0 starts the film anew; sample n is added to those before it.
struct Samples {
    Samples(unsigned first_sample, unsigned how_many = 1, std::function<bool(unsigned)> told = {})
        : first(first_sample), count(how_many), complete(std::move(told)) {}
    unsigned first, count;
    // If set, called from time to time with the number of samples in the film. Returning false stops the trace.
    std::function<bool(unsigned)> complete;
};

// Traces pictures on one device and owns their film. Used from one thread.
class FrameRenderer {
 public:
    explicit FrameRenderer(std::shared_ptr<Device> device);
    ~FrameRenderer();

    // Traces samples into the film. Width, height, depth, shadows and other settings that need no rebuild come from `settings`;
    // everything else comes from `prepared`. The work is cut into launches of less than half a second; a launch may hold
    // several short samples. `progress` is asked between launches. Throws Error(failed), and Cancelled after a cancel.
    // shared: the rows to trace; null traces all. The read functions below then return these rows only.
    // meanwhile: called once while the device is busy. Use it to wait for the previous picture.
    FrameStats trace(const Prepared& prepared, const Settings& settings, const View& view, const Samples& samples,
                     bool count_rays, Progress& progress, const SharedRows* shared = nullptr,
                     const std::function<void()>& meanwhile = {});
    // Writes the ray counts and full stacks of the last sample to `stats`, as trace() does with count_rays.
    void count(FrameStats& stats);

    // Returns the mean of the film's samples: 3 channels for color, normal and uv, else 1. prim and instance are numbers; -1:
    // no hit.
    FloatImage read_values();
    // Returns the distance along the camera ray of sample 0 of the last picture: 1 channel, +inf where nothing was hit. Empty
    // for AOVs of camera rays other than `t`, whose programs do not store it.
    FloatImage read_distance();
    // These two write the traced rows into an image of the whole picture, which other devices fill too. read_distance() returns
    // false if the distance is not known.
    void read_values(FloatImage& image);
    bool read_distance(FloatImage& image);
    // Writes the traced rows into a picture of the whole size: RGBA8, top row first. Only for colours.
    void read_display(const Settings& settings, uint8_t* rgba, std::vector<KernelTime>& times);
    // Appends the times of that work if trace() did it (SharedRows::display).
    void add_display_times(std::vector<KernelTime>& times);
    // Returns the picture as sRGB: colours tone-mapped, other AOVs in false colours. If given, `stats` gets the times of this
    // work and `scale` the scale of the false colours.
    ByteImage read_display(const Settings& settings, FrameStats* stats = nullptr, FalseColorScale* scale = nullptr);
    // The same for colours, without waiting for the copy. The next picture may be traced before this one is waited for. This is
    // faster only if copies_aside(), because the copy then runs while the device traces.
    AsyncReadback begin_display(const Settings& settings);
    bool copies_aside() const;

    // Traces the caller's own rays, for tests and benchmarks. If given, *device_ms becomes the time by the device's clock.
    std::vector<rt_hit> trace_rays(const Prepared& prepared, const std::vector<rt_ray>& rays, RayQuery query,
                                   double* device_ms = nullptr);
    // The same for rays packed beforehand for prepared.settings.lanes: faster if they are traced repeatedly. Returns ms of
    // device time.
    double trace_rays(const Prepared& prepared, const RayBlocks& rays, RayQuery query, std::vector<rt_hit>* hits = nullptr);
    RayTuning ray_tuning() const;

 private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace clarity
