// shape_values.hpp -- values for the keys of a shape: usual ones, ones at the ends of their ranges, and what they become.
#pragma once
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "rt_plugin.h"
#include "scene/scene.hpp"

namespace clarity::check {

struct ShapeValues {
    struct Key {
        std::vector<float> numbers;
        bool given = false;  // in the statement; otherwise these are the defaults
    };
    std::vector<Key> keys;  // one for each key of the plugin
    std::string what;       // "radius at its least value, 1e-12"; empty: usual values

    // The same as a statement of a text scene: "torus center 0 1 0 radius 2".
    std::string statement(const rt_plugin& plugin) const;
};

// Values within the keys' ranges, of about the size of 1. Optional keys are given by chance.
ShapeValues random_values(const rt_primitive& primitive, std::mt19937& random);
// Each key with a range at its least and greatest value, while the others are as in `usual`.
std::vector<ShapeValues> values_at_ends(const rt_primitive& primitive, const ShapeValues& usual);

// What the plugin makes of values.
struct ShapeTrial {
    ShapeValues values;
    Scene scene;      // with one shape, if `why` is empty
    std::string why;  // the plugin refuses the values
    Failure failure = Failure::other;
};
ShapeTrial try_values(const rt_plugin& plugin, const ShapeValues& values);

// Usual values that the plugin accepts: at most `count`. seed: of random numbers (stand/seed.hpp). `refused` gets those that it
// refused on the way.
std::vector<ShapeTrial> accepted_trials(const rt_plugin& plugin, size_t count, uint64_t seed,
                                        std::vector<ShapeTrial>* refused = nullptr);

}  // namespace clarity::check
