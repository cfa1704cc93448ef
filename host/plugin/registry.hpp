// registry.hpp -- finds, checks and holds plugins.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rt_plugin.h"

namespace clarity {

struct PluginRecord {
    std::string path;
    const rt_plugin* plugin = nullptr;  // nullptr: refused; `why` says why
    std::string why;                    // "ABI version 2, this host speaks 1: rebuild it against this SDK"
    bool shadowed = false;              // loaded, but an earlier library has the same id; not used
};

// Every library seen, in the order of discovery: --plugin files, CLARITY_PLUGIN_PATH (colon list of folders), then
// $XDG_DATA_HOME/clarity/plugins, then ../lib/clarity/plugins/{importers,accel} relative to the executable (the libraries'
// install folder too). Never the working directory. Libraries are loaded RTLD_NOW|RTLD_LOCAL and never closed.
class PluginRegistry {
 public:
    static PluginRegistry discover(const std::vector<std::string>& plugin_files = {});
    // Exactly these libraries, without a search: what a process that discovered them hands on to its worker.
    static PluginRegistry of(const std::vector<std::string>& plugin_files);

    const std::vector<PluginRecord>& records() const { return records_; }
    // nullptr if there is none of that id.
    const rt_plugin* accel(std::string_view id) const;
    const rt_plugin* importer(std::string_view id) const;
    std::vector<const rt_plugin*> accels() const;     // usable ones, by id
    std::vector<const rt_plugin*> importers() const;  // usable ones, by id
    // The importer most certain of a file, by extension and first bytes; nullptr if none takes it.
    const rt_plugin* importer_for(const std::string& path) const;

 private:
    std::vector<PluginRecord> records_;
};

// Loads one library and checks it: never throws, never runs its code. plugin == nullptr and `why` if it is refused.
PluginRecord load_plugin(const std::string& path);

}  // namespace clarity
