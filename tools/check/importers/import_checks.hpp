// import_checks.hpp -- whether an importer reads what it should, and survives what it should not.
#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "plugin/registry.hpp"
#include "tools/check/importers/samples.hpp"
#include "tools/check/steps.hpp"

namespace clarity::check {

// What the checks of an importer work on. Everything is read before the sandbox closes.
struct ImportInputs {
    PluginRegistry plugins;  // the importer first, then those of files that samples load
    const rt_plugin* plugin = nullptr;
    std::vector<std::string> samples;
    std::map<std::string, Contents> truths;  // by sample
    // By sample: what import_digest() says in a process that has read nothing before. Of some samples.
    std::map<std::string, std::string> alone;
    std::vector<HostileFile> hostile;
    uint64_t seed = 0;  // of random numbers: see seed.hpp
};

// How many samples are read after others, and alone.
inline constexpr size_t kMostAlone = 10;
// Reads a file; returns the digest of its scene, or why there is none.
std::string import_digest(const ImportInputs& inputs, const std::string& path);

// The checks of one importer, in the order in which they run. quick: fewer repetitions.
std::vector<Check> import_checks(const std::shared_ptr<const ImportInputs>& inputs, bool quick);

}  // namespace clarity::check
