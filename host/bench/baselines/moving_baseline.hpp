// moving_baseline.hpp -- a baseline whose triangles move.
#pragma once
#include <memory>
#include <string>

#include "bench/baselines/baseline.hpp"

namespace clarity::bench {

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
