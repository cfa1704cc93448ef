// file_watch.hpp -- notices when files change, once per save, however an editor saves.
//
// A thread waits for inotify events of the files' folders. It then compares the content of the files: a save that changes
// nothing is no change, and neither is a file that was missing for a moment. Twice a second it also compares the files' times,
// because inotify does not report everything (network and shared folders, symbolic links, a folder that was removed and created
// again). Where inotify cannot be used, this is the only check.
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace clarity {

class FileWatch {
 public:
    // What counts as a change. content: another content, or none. times: for files that may be too large to be read for it:
    // another time, size or file, once nothing is written any more and no file is missing that was there.
    enum class Rule { content, times };
    // files: paths, which need not exist yet; later states are compared with the present one. changed: called on the watch's
    // own thread after each change; it must not destroy the watch.
    FileWatch(std::vector<std::string> files, std::function<void()> changed, Rule rule = Rule::content);
    ~FileWatch();
    FileWatch(const FileWatch&) = delete;
    FileWatch& operator=(const FileWatch&) = delete;

    // Number of changes so far. Saves within 50 ms of each other count as one change.
    uint64_t revision() const { return revision_; }
    // The files that changed last, for a line in the log.
    std::vector<std::string> last_changed() const;
    const std::vector<std::string>& files() const { return paths_; }
    // True if inotify watches every folder that exists; otherwise changes are noticed up to half a second late.
    bool prompt() const { return prompt_; }

 private:
    // State of a file when it was last looked at. All zero: the file is missing.
    struct State {
        uint64_t device = 0, inode = 0, bytes = 0, hash = 0;
        int64_t modified_ns = 0;
        bool same_file(const State& other) const;
    };
    static State look(const std::string& path);
    void run();
    void add_folders();
    bool drain();
    bool times_differ() const;
    bool lacks_one() const;
    void settle();
    void compare();

    const std::vector<std::string> paths_;
    const std::function<void()> changed_;
    const Rule rule_;
    std::vector<std::string> folders_;
    std::vector<int> watches_;  // inotify watch of each folder in folders_; -1: none
    std::vector<State> states_;
    int inotify_ = -1, stop_ = -1;
    std::atomic<uint64_t> revision_{0};
    std::atomic<bool> prompt_{false};
    mutable std::mutex mutex_;
    std::vector<std::string> last_changed_;
    std::thread thread_;  // declared last: the thread uses all other members
};

}  // namespace clarity
