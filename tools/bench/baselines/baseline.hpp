// baseline.hpp -- other ray tracers, which trace the same triangles and rays for comparison.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "base/aligned_bytes.hpp"
#include "base/problem.hpp"
#include "stand/ray_sets.hpp"
#include "tools/bench/baselines/whitted.hpp"

namespace clarity::bench {

// Indexed triangles of a scene in world space.
struct BaselineMesh {
    std::vector<float> positions;   // 3 per vertex, then one float of padding, because Embree reads 16 bytes per vertex
    std::vector<rt_u32> triangles;  // 3 vertex indices per triangle, in the order of rt_hit.prim
    std::vector<float> normals;     // 3 per vertex, (0, 0, 0) for a vertex without one; empty: the scene has none
    rt_u32 vertex_count() const { return static_cast<rt_u32>(positions.size() / 3); }
    rt_u32 triangle_count() const { return static_cast<rt_u32>(triangles.size() / 3); }
};
BaselineMesh make_baseline_mesh(const Scene& scene);
// Returns the reason why the baselines cannot trace this scene (it has other primitives than triangles), "" if they can.
Problem baselines_cannot(const Scene& scene);

struct BaselineHit {
    float t;  // distance; +inf: nothing was hit. Any-hit query: 0 if something was hit
    rt_i32 prim;
};
// Arrays in large pages, like our own buffers.
template <class T>
using BaselineArray = std::vector<T, DefaultInitAllocator<T>>;

struct BaselineRayCounts {  // rays traced, by kind
    uint64_t primary = 0, shadow = 0, secondary = 0;
};

// A structure of a baseline over one mesh.
class BaselineScene {
 public:
    virtual ~BaselineScene() = default;
    virtual double build_ms() const = 0;
    // Memory of the structure after the build, without the mesh.
    virtual uint64_t bytes() const = 0;
    // Modes of tracing: "single", "packet8", "packet16".
    virtual const std::vector<std::string>& modes() const = 0;
    // Converts the rays to the layout which the baseline prefers; not timed.
    virtual void take_rays(const RaySet& rays) = 0;
    // Traces the rays of take_rays(). Returns the wall time in ms. `hits` holds at least one entry per ray; entries of inactive
    // rays are undefined.
    virtual double trace_ms(const std::string& mode, BaselineArray<BaselineHit>& hits) = 0;
    // Modes of rendering a whole frame; frame_ms() renders one frame and returns the wall time in ms. film: r, g, b and the
    // number of samples of each pixel.
    virtual const std::vector<std::string>& frame_modes() const = 0;
    virtual double frame_ms(const std::string& mode, const WhittedScene& whitted, BaselineArray<float>& film,
                            BaselineRayCounts& counts) = 0;
};

// A kind of structure which a baseline builds.
struct BaselineKind {
    std::string name;     // "embree"
    std::string quality;  // "low", "medium", "high"
    // Builds the structure with so many threads. The mesh must outlive it. Throws Error(failed).
    std::unique_ptr<BaselineScene> (*build)(const BaselineMesh& mesh, const std::string& quality, unsigned threads);
};
// The kinds this program was built with. If there are none, `why` receives the reason.
std::vector<BaselineKind> baseline_kinds(std::string* why);
// Name and version of the library that runs: "Embree 4.3.3". "": this program was built without it.
std::string baseline_version();

// A baseline with triangles that move.

class MovingBaseline {
 public:
    virtual ~MovingBaseline() = default;
    // The vertices that the next update() reads: as many as the mesh has.
    virtual float* positions() = 0;
    // Brings the structure up to date. Returns the wall time in ms.
    virtual double update_ms() = 0;
    virtual uint64_t bytes() const = 0;
};

// Embree with one mesh in a dynamic scene. quality: "refit" keeps the tree of a build of medium quality; "low" and "medium"
// build anew at each update. The mesh must outlive it. nullptr: this program was built without Embree. Throws Error(failed).
std::unique_ptr<MovingBaseline> make_moving_baseline(const BaselineMesh& mesh, const std::string& quality, unsigned threads);

}  // namespace clarity::bench
