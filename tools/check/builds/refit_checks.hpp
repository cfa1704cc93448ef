// refit_checks.hpp -- whether a structure's `refit` follows primitives that moved (rt_refit.h).
#pragma once
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "tools/check/builds/build_run.hpp"
#include "tools/check/steps.hpp"

namespace clarity::check {

// A motion of all vertices and instances of a scene.
struct Movement {
    const char* name;
    Scene (*move)(Scene scene);
    bool is_flat = false;  // volumes have no extent afterwards, and costs say nothing
};
// At rest, a wave, a twist, scattered, in one plane, at one point, and a million times as large.
const std::vector<Movement>& movements();

// The check of one structure.
Check refit_check(const rt_plugin& plugin, bool quick);

}  // namespace clarity::check
