// path.hpp -- a path tracer in double precision by brute force, for comparison: rays find lights with a size and the sky by
// chance, and only lights without a size, and suns, are asked directly. It shares no code with cl/, has no Russian roulette and
// no textures.
#pragma once
#include <cstdint>
#include <vector>

#include "scene/scene.hpp"
#include "scene/vec.hpp"
#include "view/view.hpp"

namespace clarity::reference {

// Linear light of each pixel, row by row from the top, and the standard error of it.
struct PathPicture {
    unsigned width, height;
    std::vector<Vec> mean, error;
    // Over all pixels.
    Vec total() const;
    double total_error(int channel) const;
};

struct PathLimits {
    unsigned width, height;
    unsigned depth;    // scattering events; the last ray finds emission only
    unsigned samples;  // of a pixel, drawn uniformly in it
    uint64_t seed = 1;
    int bounce = -1;  // light that came by so many events only; -1: all
};

// Keeps no reference. Throws std::invalid_argument if the scene has textures.
PathPicture trace_paths(const Scene& scene, const View& view, const PathLimits& limits);

}  // namespace clarity::reference
