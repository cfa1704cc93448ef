// baseline.hpp -- other people's ray tracers, on the same triangles and rays.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "base/aligned_bytes.hpp"
#include "bench/baselines/whitted.hpp"
#include "bench/suites/ray_sets.hpp"

namespace clarity::bench {

// World-space triangles of a scene, indexed.
struct BaselineMesh {
    std::vector<float> positions;   // 3 per vertex, and one float of padding, which Embree reads
    std::vector<rt_u32> triangles;  // 3 per triangle, in the order of rt_hit.prim
    std::vector<float> normals;     // 3 per vertex, (0, 0, 0) where there is none; empty: none at all
    rt_u32 vertex_count() const { return static_cast<rt_u32>(positions.size() / 3); }
    rt_u32 triangle_count() const { return static_cast<rt_u32>(triangles.size() / 3); }
};
BaselineMesh make_baseline_mesh(const Scene& scene);
// Why peers cannot trace this scene (it holds more than triangles); empty if they can.
std::string baselines_cannot(const Scene& scene);

struct BaselineHit {
    float t;  // +inf: nothing; any hit: 0 where occluded
    rt_i32 prim;
};
// In large pages, as the buffers of ours are.
template <class T>
using BaselineArray = std::vector<T, DefaultInitAllocator<T>>;

struct BaselineRayCounts {
    uint64_t primary = 0, shadow = 0, secondary = 0;
};

// One structure of a peer over one mesh.
class BaselineScene {
 public:
    virtual ~BaselineScene() = default;
    virtual double build_ms() const = 0;
    // All that it holds besides the mesh; after the build.
    virtual uint64_t bytes() const = 0;
    // Ways to trace it: "single", "packet8", ...
    virtual const std::vector<std::string>& modes() const = 0;
    // Brings rays into the form that it likes best; not timed.
    virtual void take_rays(const RaySet& rays) = 0;
    // Traces them; wall time. hits: one a ray or more; of inactive rays undefined.
    virtual double trace_ms(const std::string& mode, BaselineArray<BaselineHit>& hits) = 0;
    // Ways to render a whole frame; and one frame: wall time. film: r, g, b and the number of samples of each pixel.
    virtual const std::vector<std::string>& frame_modes() const = 0;
    virtual double frame_ms(const std::string& mode, const WhittedScene& whitted, BaselineArray<float>& film,
                            BaselineRayCounts& counts) = 0;
};

// A kind of structure that a peer builds.
struct BaselineKind {
    std::string name;     // "embree"
    std::string quality;  // "low", "medium", "high"
    // The mesh must outlive it. Throws Error(failed).
    std::unique_ptr<BaselineScene> (*build)(const BaselineMesh& mesh, const std::string& quality, unsigned threads);
};
// Those that this program was built with; none: `why` says so.
std::vector<BaselineKind> baseline_kinds(std::string* why);

}  // namespace clarity::bench
