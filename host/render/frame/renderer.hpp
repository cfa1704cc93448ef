// renderer.hpp -- from a scene and settings to a picture.
//
// Two steps. prepare() does what is slow - build, upload, compile - and gives an immutable Prepared; it may run on any thread
// while frames go on with the last one. Frames::trace() does one sample of one frame with a Prepared. What did not change
// between two prepare() calls is shared between their results, so nothing is redone without need.
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

class DeviceScene;   // buffers of one scene in one structure
class TraceProgram;  // compiled kernels of one specialisation
class ProgramCache;
class RayBlocks;  // rays as kernels read them: ray_blocks.hpp

// Immutable. Keeps its device open and its memory there in use: see Preparer::close_device().
struct Prepared {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const AccelData> accel;
    std::shared_ptr<const DeviceScene> on_device;
    std::shared_ptr<const TraceProgram> program;
    Settings settings;                     // as asked for, with what was automatic resolved
    Layout layout;                         // that follows from them
    double compile_ms = 0, upload_ms = 0;  // 0 if shared with an earlier one
    bool compile_cached = false;
};

// Thread-safe; one prepare() at a time per object.
class Preparer {
 public:
    Preparer(const PluginRegistry& plugins, std::shared_ptr<Device> device);
    ~Preparer();
    // Throws Error(failed) for a build, Error(kernel_build_failed) with the compiler's log in details(), Cancelled; then what
    // was prepared before stays valid.
    // built: what build() gave for these settings, or for another device; without it, prepare() builds.
    std::shared_ptr<const Prepared> prepare(std::shared_ptr<const Scene> scene, const Settings& settings, Progress& progress,
                                            std::shared_ptr<const AccelData> built = nullptr);
    // The structure alone, which needs no device.
    std::shared_ptr<const AccelData> build(const std::shared_ptr<const Scene>& scene, const Settings& settings,
                                           Progress& progress);
    // Whether the device should be closed and opened anew: PoCL frees what its compiler made, 0.15 MB a program and more, only
    // with the last context of a process, and whoever edits kernels compiles hundreds.
    bool needs_reopen() const;
    // Lets go of the device and of all programs and buffers on it; keeps the last structure. The device closes when the caller
    // has let go of it too: of its Device, of every Prepared, and of Frames and Inspectors. Returns the info to open a new
    // Device with. Until open_device(), prepare() throws Error(no_device).
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

// What may change from frame to frame for nothing.
struct View {
    Camera camera;
    std::vector<rt_light> lights;
    std::vector<rt_material> materials;  // one for each of the scene's; empty: the scene's own
    std::array<float, 3> background{}, ambient{};
};
// The scene's first camera (or the one of that name; or a framing one), its lights (or two that suit its size), background.
// camera: "" or a name or "ex,ey,ez,tx,ty,tz[,fov_deg]". light: "" or "x,y,z", which moves the first light. Throws
// Error(usage).
View make_view(const Scene& scene, float aspect, const std::string& camera = {}, const std::string& light = {});

// One piece of a frame's work, by the device's clock.
struct KernelTime {
    std::string name;
    double ms = 0;
};

// What one device did of a picture that several share.
struct DeviceShare {
    std::string id, name;
    double share = 0;                     // 0..1 of the picture's rows
    double device_ms = 0, wall_ms = 0;    // of tracing, by the device's clock and by its host thread's
    double tone_map_ms = 0, read_ms = 0;  // of read_display(), by the device's clock
    unsigned launches = 0;
};

struct FrameStats {
    double device_ms = 0;                                          // the kernels of these samples, by the device's clock
    double wall_ms = 0;                                            // the same by the host's, waiting included
    uint64_t primary = 0, shadow = 0, secondary = 0, dropped = 0;  // rays of these samples; counted if asked for
    uint64_t overflowed = 0;                                       // traversal stacks that were full (debug programs)
    unsigned samples = 0;                                          // in the film now
    unsigned launches = 0;                                         // that these samples were cut into
    std::vector<KernelTime> kernels;   // trace, counters, what adds samples up; read_display() adds tone map and read-back
    std::vector<DeviceShare> devices;  // where several share the picture; then what is above is of the slowest
};

// Rows of work-groups that a device has of a picture which several devices share, in the order they came to it. A sample may
// be traced in several calls, while rows come in: those before `begin` are done.
struct SharedRows {
    std::vector<rt_u32> rows;
    size_t begin = 0;
    uint8_t* display = nullptr;  // where trace() is to bring them, as read_display() does, behind the last sample
};

// How trace_rays() asks.
struct RayQuery {
    bool any_hit = false;  // only whether something lies between t_min and t_max
    bool count = false;    // fill in steps, leaf_tests and lane_steps; another, slower program: leave it out to take times
    bool brief = false;    // only t and prim of the nearest hit: less to write, for timing beside others who write no more
};

// How the last trace_rays() was done. Each set of rays is tried in several ways (autotuner.hpp).
struct RayTuning {
    unsigned way = 0;     // its number; 0 is the plain kernel
    bool trial = false;   // a try of this way, which may be a slow one: its time is no measurement
    bool settled = true;  // the way is chosen, and a run has confirmed it
};

// Samples of a picture, one after the other; 0 starts the film anew, n adds the n-th.
struct Samples {
    Samples(unsigned first_sample, unsigned how_many = 1, std::function<bool(unsigned)> told = {})
        : first(first_sample), count(how_many), complete(std::move(told)) {}
    unsigned first, count;
    std::function<bool(unsigned)> complete;  // if not empty, told by and by how many the film has; false: stop
};

// Owns the film of one device. Used from one thread.
class FrameRenderer {
 public:
    explicit FrameRenderer(std::shared_ptr<Device> device);
    ~FrameRenderer();

    // settings: width, height, depth, shadows and the like are taken from here; what needs a rebuild or recompile from
    // `prepared`. Cut into launches under half a second, of several samples where these are short; between them `progress` is
    // asked, and a cancel throws Cancelled.
    // shared: the rows to trace, null for all; what is read back below is then theirs alone.
    // meanwhile: called once while the device is at it, for who waits for the picture before.
    FrameStats trace(const Prepared& prepared, const Settings& settings, const View& view, const Samples& samples,
                     bool count_rays, Progress& progress, const SharedRows* shared = nullptr,
                     const std::function<void()>& meanwhile = {});
    // Adds the rays of the last sample and its full stacks, as trace() does if it is to count them.
    void count(FrameStats& stats);

    // The film's mean as floats: 3 channels for color, normal, uv; 1 for the others, prim and instance as numbers, -1 for none.
    FloatImage read_values();
    // Distance along the camera ray of sample 0 of the picture traced last, +inf where nothing is; 1 channel. Empty where the
    // program does not know it: any AOV but `t`.
    FloatImage read_distance();
    // The rows traced, into a picture of the whole size that other devices fill too. False: the distance is not known.
    void read_values(FloatImage& image);
    bool read_distance(FloatImage& image);
    // Colours only, of the rows traced, into a picture as above.
    void read_display(const Settings& settings, uint8_t* rgba, std::vector<KernelTime>& times);
    // What that took, where trace() did it.
    void add_display_times(std::vector<KernelTime>& times);
    // Tone-mapped sRGB; AOVs in false colours, whose scale is told. stats: where given, gains the times of what this took.
    ByteImage read_display(const Settings& settings, FrameStats* stats = nullptr, FalseColorScale* scale = nullptr);
    // The same of colours without waiting; the next picture may be traced before this one is waited for. That pays where
    // copies_aside(): there it is copied meanwhile.
    AsyncReadback begin_display(const Settings& settings);
    bool copies_aside() const;

    // Rays of the caller's own, for tests and benches.
    std::vector<rt_hit> trace_rays(const Prepared& prepared, const std::vector<rt_ray>& rays, RayQuery query,
                                   double* device_ms = nullptr);
    // The same packed beforehand for prepared.settings.lanes, for who traces them again and again: ms by the device's clock.
    double trace_rays(const Prepared& prepared, const RayBlocks& rays, RayQuery query, std::vector<rt_hit>* hits = nullptr);
    RayTuning ray_tuning() const;

 private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace clarity
