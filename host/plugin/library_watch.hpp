// library_watch.hpp -- notices plugin libraries that are built again while the program runs, and puts them into force.
//
// The dynamic loader knows a file only once, so a rebuilt library is copied to a file of its own, which is loaded; workers load
// the same copy. The library before it is never closed: structures that it built may still be traced. A library that fails its
// checks leaves the one before in force.
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/files/file_watch.hpp"
#include "plugin/parameters.hpp"
#include "plugin/registry.hpp"

namespace clarity {

// What became of a library that was built again.
struct RebuiltLibrary {
    std::string path;
    const rt_plugin *before = nullptr, *now = nullptr;  // now == nullptr: it was refused
    std::string why;                                    // a message for the user, if it was refused
};

class LibraryWatch {
 public:
    // changed: called on the watch's own thread when apply() has something to do; it must not destroy the watch.
    LibraryWatch(const PluginRegistry& plugins, std::function<void()> changed);
    ~LibraryWatch();

    // Grows with every library that apply() could take.
    uint64_t revision() const { return revision_; }
    // Puts the libraries that were built since the last call into force in the registry. Does not wait.
    std::vector<RebuiltLibrary> apply();

 private:
    void load_changed();
    bool load(const std::string& path);
    bool wait_until_written(const std::string& path) const;
    bool sleep(int milliseconds) const;

    PluginRegistry plugins_;
    const std::function<void()> changed_;
    std::atomic<uint64_t> revision_{0};
    std::atomic<bool> stop_{false};
    std::map<std::string, std::string> last_copies_;  // by path: the copy that was loaded last; used by the watch's thread only
    std::mutex mutex_;
    std::vector<PluginRecord> loaded_;  // waiting for apply()
    std::unique_ptr<FileWatch> files_;  // declared last: its thread uses all other members
};

// The values of parameters for a plugin that was built again: a parameter keeps its value if it still has its key and range.
ParameterValues carried_parameters(const rt_plugin& before, const rt_plugin& now, const ParameterValues& values);

}  // namespace clarity
