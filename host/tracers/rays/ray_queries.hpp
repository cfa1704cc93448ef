// ray_queries.hpp -- traces the caller's own rays with the traversals that pictures use.
#pragma once
#include <functional>
#include <list>
#include <map>
#include <optional>
#include <tuple>

#include "device/device.hpp"
#include "kernels/kernel_source.hpp"
#include "kernels/layout.hpp"
#include "kernels/program_cache.hpp"
#include "launch/launch.hpp"
#include "launch/ping_pong.hpp"
#include "launch/prepared.hpp"
#include "launch/view_buffers.hpp"
#include "picture/overflow_counter.hpp"
#include "tracers/rays/autotuner.hpp"
#include "tracers/rays/host_copies.hpp"
#include "tracers/rays/ray_blocks.hpp"
#include "tracers/rays/ray_query.hpp"

namespace clarity {

// Rays that lie in arrays of the caller's own, or on the device.
struct RayArrays {
    size_t count = 0;
    uint64_t packing = 0;  // as RayBlocks::packing(). Pieces of one set of rays may have one number
    cl::Buffer packed;     // by pack_on_device(); without it `read` gives the rays
    ReadRays read;
    size_t room = 0;        // the buffers are made for so many rays, or for `count` if that is more
    uint64_t prepared = 0;  // a number that each Prepared has for itself; 0: not known. Kernels are looked up once for it
    // Of a larger set of rays these are those from `first` on, a multiple of the lanes, and all answers lie in `all`, which has
    // answer_fields() numbers. Without `all`, answers lie in a buffer of the queries until the next one.
    const Answers* all = nullptr;
    size_t first = 0;
};

// Ray queries on one device, and the choice of the fastest kernel for them. Used from one thread.
class RayQueries {
 public:
    explicit RayQueries(std::shared_ptr<Device> device)
        : device_(device), copies_(std::make_shared<HostCopies>(device)), programs_(device) {}
    // Traces the rays and returns the kernel's time, ms by the device's clock. If `hits` is null, the answers stay on the
    // device. Throws Error(failed) if the rays were packed for another number of lanes. If traversal stacks of a debug program
    // were full, this is logged as an error.
    double trace(const Prepared& prepared, const RayBlocks& rays, RayQuery query, std::vector<rt_hit>* hits = nullptr);
    // The same with arrays of the caller's own, of which one pass is made. The answers stay on the device: read_answers().
    double trace(const Prepared& prepared, const RayArrays& rays, RayQuery query, Answers& answers);
    static cl_uint answer_fields(const Prepared& prepared, const RayQuery& query);
    const std::shared_ptr<HostCopies>& copies() const { return copies_; }
    // Rays that stay on the device.
    cl::Buffer pack_on_device(size_t count, unsigned lanes, const ReadRays& read);
    // As the first, and packs the rays. Rays that are traced repeatedly are better packed once.
    std::vector<rt_hit> trace(const Prepared& prepared, const std::vector<rt_ray>& rays, RayQuery query = {});
    // All hits of each ray with t_min <= t < t_max, not only the nearest. A triangle, a polygon or a plane is hit once, a
    // sphere at both sides, a shape wherever its plugin finds another hit behind one (cl/primitives/leaf_shape.h). A primitive
    // that a structure names several times counts once. Rays with more hits than a launch lists are traced again behind the
    // last one that is known, so none is lost. Throws Error(failed) and Cancelled.
    AllHits trace_all(const Prepared& prepared, const std::vector<rt_ray>& rays, AllHitsQuery query, Progress& progress);
    // How the last trace() ran.
    RayTuning tuning() const { return tuning_; }
    // How many traversal stacks were full in the last trace() or trace_all(). 0 for programs that are not for debugging.
    uint64_t overflows() const { return overflowed_; }

 private:
    // Rays of a query. upload: returns the buffer that has them.
    struct Given {
        size_t count, room;
        unsigned lanes;
        uint64_t packing, prepared;
        bool answers_are_read;  // soon: few of them at once
        std::function<cl::Buffer()> upload;
    };
    // answers: gets those of this query. If it has a buffer already, they are written there.
    double trace(const Prepared& prepared, const Given& rays, const RayQuery& query, Answers& answers);
    // The frame that kernels read, for rays of this mask.
    void write_frame(const Prepared& prepared, rt_u32 mask);
    void write_rays(const cl::Buffer& in, size_t count, unsigned lanes, const ReadRays& read);
    // What stays from query to query of one Prepared: to make a kernel's text and to find its program by it takes longer than
    // to trace a million rays, and the frame and the scene's arguments take longer than a launch.
    struct LookedUp {
        uint64_t prepared = 0, text_revision = 0;
        std::optional<rt_u32> mask;  // of the frame on the device; without one, that is another query's
        std::map<const KernelRow*, std::shared_ptr<TraceProgram>> programs;
        std::map<std::pair<const TraceProgram*, std::string>, KernelArguments> kernels;  // by their entries
    };
    TraceProgram& program_of(const Prepared& prepared, uint64_t number, const KernelRow& row, Progress& progress);
    // One launch of a query.
    struct Launch {
        const Prepared& prepared;
        const TraceProgram& program;
        unsigned blocks;
        bool any_hit;
        const cl::Buffer& in;
        const Answers& answers;
        const Progress* progress;
        Launcher& launcher;
        SideWork side_work;
        void go_on() const {
            if (progress && progress->cancelled()) throw Cancelled();
        }
    };
    // The numbers of rays in a list on the device, of this launch and of the next, and the list.
    struct Counted {
        GrowingBuffer buffer{CL_MEM_READ_WRITE};
        PingPong parity;
        const cl::Buffer& fit(const cl::Context& context, size_t rays);
        void take(Queue& queue, const std::function<void(cl_uint parity)>& enqueue);
    };
    KernelArguments& kernel_of(const Launch& launch, const char* entry = nullptr);
    // One launch for all hits behind those that are known. Returns the lists of all blocks (cl/tracers/rays/all_hits.cl).
    std::vector<float> list_hits(const Prepared& prepared, const TraceProgram& program, const RayBlocks& rays,
                                 const std::vector<float>& after);
    LaunchTimes trace(const Launch& launch);
    LaunchTimes trace_at_once(const Launch& launch);
    // Two launches: the first stops rays that exceed a step budget and lists them; the second traces each of these with several
    // work-items side by side (cl/tracers/rays/requeued_rays.cl).
    LaunchTimes trace_requeued(const Launch& launch);
    // Persistent work-items fetch a new ray whenever they are free (cl/tracers/rays/dynamic_fetch.cl; Aila, Laine 2009,
    // Understanding the Efficiency of Ray Traversal on GPUs).
    LaunchTimes trace_fetching(const Launch& launch);

    std::shared_ptr<Device> device_;
    std::shared_ptr<HostCopies> copies_;
    ProgramCache programs_;  // of all kernels for ray queries
    LookedUp looked_up_;
    ViewBuffers view_;
    Counted long_rays_, fetched_;
    static constexpr uint64_t kFew = 0;  // stands for the packings of few rays, which no packing has
    // How a query of some rays is traced. The fastest variant depends on both: mirror rays may need another one than diffuse
    // rays.
    struct Choice {
        uint64_t packing = kFew;
        bool any_hit = false, count = false, brief = false;
        std::vector<const KernelRow*> kernels;
        Autotuner autotuner;
        size_t blocks = 0;  // those of the launchers' pace: if they stay the same, a short query is a single launch
        std::map<const KernelRow*, Launcher> launchers;
        bool is(uint64_t other, const RayQuery& query) const {
            return std::tie(packing, any_hit, count, brief) == std::tie(other, query.any_hit, query.count, query.brief);
        }
    };
    Choice& choice_for(const Prepared& prepared, uint64_t packing, size_t blocks, const RayQuery& query);
    // Callers trace few sets of rays by turns. Each needs some 15 launches until its fastest variant is chosen.
    static constexpr size_t kMostChoices = 16;
    std::list<Choice>
        choices_;  // the last one first, all of this scene and this program of pictures, which changes with settings
    std::shared_ptr<const DeviceScene> scene_;
    std::shared_ptr<const TraceProgram> program_;
    Launcher all_hits_launcher_;
    RayTuning tuning_;
    uint64_t overflowed_ = 0;
    OverflowCounter overflows_;  // used for debug programs
    GrowingBuffer in_{CL_MEM_READ_ONLY}, after_{CL_MEM_READ_ONLY}, out_{CL_MEM_READ_WRITE};
};

}  // namespace clarity
