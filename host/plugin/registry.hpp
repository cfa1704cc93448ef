// registry.hpp -- finds, checks and owns plugins.
#pragma once
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "base/problem.hpp"
#include "rt_plugin.h"

namespace clarity {

struct PluginRecord {
    std::string path;
    const rt_plugin* plugin = nullptr;  // a copy of the host's (plugin_copy.hpp); nullptr: refused, `why` tells the reason
    std::string why;                    // "ABI version 2, this host speaks 1: rebuild it against this SDK"
    bool shadowed = false;              // loaded but not used, because an earlier library has the same id
    std::string loaded;     // the file that is loaded, also by workers: `path`, or a private copy of it (library_watch.hpp)
    unsigned replaced = 0;  // how often a rebuilt library took the place of the one before; those stay loaded
};

// All libraries that were found, in this order: --plugin files, the folders in CLARITY_PLUGIN_PATH (separated by colons),
// $XDG_DATA_HOME/clarity/plugins, then the program's own plugins (in the library folder of the installation, or
// ../lib/clarity/plugins/{importers,accel,primitives} relative to the executable in a build folder). The working directory is
// never searched. Libraries are loaded with RTLD_NOW|RTLD_LOCAL and never closed, so a plugin stays valid even after replace().
// Copies of a registry share one list. Thread-safe.
class PluginRegistry {
 public:
    // log_refused: false if the caller tells of refused libraries itself.
    static PluginRegistry discover(const std::vector<std::string>& plugin_files = {}, bool log_refused = true);
    // Loads exactly these libraries, without a search. A process that has found them passes them on to its workers.
    static PluginRegistry of(const std::vector<std::string>& plugin_files);

    std::vector<PluginRecord> records() const;
    // Return nullptr if there is no usable plugin of that id.
    const rt_plugin* accel(std::string_view id) const;
    const rt_plugin* importer(std::string_view id) const;
    const rt_plugin* primitive(std::string_view id) const;
    // The structure whose nodes and kernels a structure uses: for a topology its layout, else the structure itself.
    const rt_plugin& layout_of(const rt_plugin& accel) const;
    std::vector<const rt_plugin*> accels() const;        // usable ones, sorted by id
    std::vector<const rt_plugin*> importers() const;     // usable ones, sorted by id
    std::vector<const rt_plugin*> primitives() const;    // usable ones, sorted by id
    std::vector<const rt_plugin*> with_kernels() const;  // accels, primitives and surfaces
    // The importer that is most certain of a file, judged by extension and first bytes, also of a packed
    // file (bunny.ply.gz); nullptr if no importer accepts it.
    const rt_plugin* importer_for(const std::string& path) const;

    // Puts a rebuilt library into force in the place of the one of the same path; `rebuilt` must be loaded. Returns an empty
    // text, or why it cannot take that place; the list then stays as it is.
    Problem replace(const PluginRecord& rebuilt);

 private:
    struct List {
        std::mutex mutex;
        std::vector<PluginRecord> records;
    };
    std::shared_ptr<List> list_ = std::make_shared<List>();
};

// "accel", "importer" or "primitive".
const char* plugin_kind(const rt_plugin& plugin);

// Loads and checks one library; never throws and calls none of its functions. If it is refused, plugin is nullptr and `why`
// tells the reason.
PluginRecord load_plugin(const std::string& path);

// Whether a library is in a plugin folder of the program itself or of the program that CLARITY_WORKER names.
bool is_own_library(const std::string& path);

}  // namespace clarity
