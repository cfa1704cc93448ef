// cache_folder.hpp -- the folder of files that may be deleted at any time, contents that are remembered there, and folders
// that are the user's own.
#pragma once
#include <filesystem>
#include <mutex>
#include <set>
#include <string>

namespace clarity {

// $XDG_CACHE_HOME/clarity, or ~/.cache/clarity; empty: there is none. It may not exist yet.
std::filesystem::path cache_folder();

// Whether a folder is safe below one that others may write to.

// Whether this is a folder of this user, and no link to one, in which nobody else may write.
bool is_own_folder(const std::filesystem::path& folder);
// Makes such a folder, unless it is there. Returns whether it is one then. Code that is loaded must be in such folders.
bool make_own_folder(const std::filesystem::path& folder);

// Contents that have been found good, by this process or an earlier one.

// A file for each content in a folder of cache_folder(), named by a hash of the content. Without such a folder only this
// process knows them. Thread-safe; reads no content itself.
class KnownContents {
 public:
    explicit KnownContents(std::string folder) : folder_(std::move(folder)) {}
    static std::string name_of(const std::string& content);
    bool has(const std::string& name);
    // note: what stands in the file, for people.
    void add(const std::string& name, const std::string& note);

 private:
    const std::string folder_;
    std::mutex mutex_;
    std::set<std::string> names_;
};

}  // namespace clarity
