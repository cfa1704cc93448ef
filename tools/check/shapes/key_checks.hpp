// key_checks.hpp -- what a shape's functions on the host make of the values of its keys, and what text scenes say about wrong
// ones.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "plugin/registry.hpp"
#include "tools/check/shapes/shape_values.hpp"
#include "tools/check/steps.hpp"

namespace clarity::check {

// What these checks work on. Files are written before the sandbox closes.
struct KeyInputs {
    PluginRegistry plugins;  // the shape first, then importers
    const rt_plugin* plugin = nullptr;
    struct Statement {
        std::string path;  // a text scene
        std::string what;  // "a word as `radius`"; empty: the plugin decides whether it takes `values`
        ShapeValues values;
    };
    std::vector<Statement> statements;
    uint64_t seed = 0;  // of random numbers: see seed.hpp
};
// Writes text scenes with usual and wrong statements into `folder`. Calls no function of the plugin.
std::vector<KeyInputs::Statement> write_statements(const rt_plugin& plugin, const std::string& folder, uint64_t seed);

// In the order in which they run. quick: fewer repetitions.
std::vector<Check> key_checks(const std::shared_ptr<const KeyInputs>& inputs, bool quick);

}  // namespace clarity::check
