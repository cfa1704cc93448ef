// checked_scene.hpp -- a structure over the mixed scene on a device, with guards around everything that its kernels read.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "device/device.hpp"
#include "tools/check/builds/build_run.hpp"
#include "tracers/rays/ray_queries.hpp"

namespace clarity::check {

// How kernels are compiled.
struct Variant {
    int lanes = 1;
    bool debug = false, portable = false;
    static Variant plain(int lanes) { return {lanes, false, false}; }
    static Variant with_debug(int lanes) { return {lanes, true, false}; }
    std::string text() const;     // "8 lanes, debug"
    std::string options() const;  // "--lanes 8 --debug true"
};

struct Traced {
    std::vector<rt_hit> hits;
    uint64_t overflows = 0;  // full traversal stacks, counted by debug programs
    // What is wrong if a stack was full; empty: none was.
    std::string full_stack() const;
};

// Numbers of the primitives behind the last leaf. They cut every ray: if one is hit, a traversal has tested a leaf that does
// not exist. On a CPU an access further behind ends the process.
constexpr rt_u32 kTrapPrim = 0x40000000u;  // an instance adds the first number of its mesh, of at most 28 bits

// How the structure is built for a scene that moves: at rest and then refitted, or refitted and then built again.
enum class Moves { none, refitted, rebuilt };

// How the structure is built.
struct BuiltAs {
    ParameterValues params;  // empty: the defaults
    rt_u32 packed_leaf = 0;  // not 0: the plugin packs halves of the scene, in leaves of that many (pack_checks.hpp)
    std::map<std::string, rt_u32> defines;  // more ones for its kernels
    Moves moves = Moves::none;
};

class CheckedScene {
 public:
    // Builds the structure. layout: what packs and traces it if the plugin builds a topology, otherwise nullptr. Throws Error
    // with the reason if the build fails. rest: the same scene in another pose, if the structure is built in that one first;
    // otherwise nullptr.
    CheckedScene(const rt_plugin& plugin, const rt_plugin* layout, Scene scene, std::shared_ptr<Device> device,
                 const Scene* rest = nullptr, const BuiltAs& as = {});
    const BuildScene& build_scene() const { return case_.scene(); }
    const Device& device() const { return *device_; }
    // Compiles on first use. Throws Error.
    void compile(const Variant& variant);
    Traced trace(const Variant& variant, const std::vector<rt_ray>& rays, bool any_hit);
    // The same by another program, which also fills in what rays count.
    Traced count(const Variant& variant, const std::vector<rt_ray>& rays, bool any_hit);
    AllHits trace_all(const Variant& variant, const std::vector<rt_ray>& rays, bool count_only);
    // For scenes that move on the device: the structure as it was built, what rays need of it, and rays in a copy of that.
    const std::shared_ptr<const AccelData>& accel() const { return accel_; }
    std::shared_ptr<const Prepared> prepared(const Variant& variant);
    Traced trace(const Prepared& in, const std::vector<rt_ray>& rays, RayQuery query);

 private:
    std::shared_ptr<const Scene> scene_;
    BuildCase case_;
    std::shared_ptr<Device> device_;
    BuildRun run_;
    GuardedBytes leaves_;
    std::shared_ptr<const AccelData> accel_;
    std::map<std::string, std::shared_ptr<const Prepared>> prepared_;
    std::unique_ptr<RayQueries> queries_;
};

}  // namespace clarity::check
