// known_contents.hpp -- contents that have been found good, by this process or an earlier one.
#pragma once
#include <mutex>
#include <set>
#include <string>

namespace clarity {

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
