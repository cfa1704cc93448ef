// import_checks.hpp -- whether an importer reads what it should, and survives what it should not.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "check/importers/samples.hpp"
#include "check/steps.hpp"
#include "plugin/registry.hpp"

namespace clarity::check {

// What the checks of an importer work on. Everything is read before the sandbox closes.
struct ImportInputs {
    PluginRegistry plugins;  // the importer first, then those of files that samples load
    const rt_plugin* plugin = nullptr;
    std::vector<std::string> samples;
    std::map<std::string, Contents> truths;  // by sample
    std::vector<HostileFile> hostile;
};

// The checks of one importer, in the order in which they run. quick: fewer repetitions.
std::vector<Check> import_checks(const std::shared_ptr<const ImportInputs>& inputs, bool quick);

}  // namespace clarity::check
