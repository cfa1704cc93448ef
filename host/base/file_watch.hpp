// file_watch.hpp -- notices when files change: once per save, however an editor saves.
//
// inotify on the files' folders wakes a thread; what counts is content, so a save that changes nothing is no change, and
// neither is a file that was away for a moment. Twice a second file times are compared too: that finds what inotify is not told
// (network and shared folders, symbolic links, a folder that was removed and made again), and is all there is where inotify has
// no room.
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
    // files: paths that need not exist yet; compared from now on. changed: called from the watch's own thread after each
    // change; it must not destroy the watch.
    FileWatch(std::vector<std::string> files, std::function<void()> changed);
    ~FileWatch();
    FileWatch(const FileWatch&) = delete;
    FileWatch& operator=(const FileWatch&) = delete;

    // Grows with each change of any of the files: saves within a twentieth of a second are one.
    uint64_t revision() const { return revision_; }
    // Which of the files changed last, for a line in the log.
    std::vector<std::string> last_changed() const;
    const std::vector<std::string>& files() const { return paths_; }
    // Whether inotify watches every folder that exists; otherwise changes are seen half a second later.
    bool prompt() const { return prompt_; }

 private:
    // What is known of a file. Missing: all zero.
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
    void settle();
    void compare();

    const std::vector<std::string> paths_;
    const std::function<void()> changed_;
    std::vector<std::string> folders_;
    std::vector<int> watches_;  // of folders_; -1: none
    std::vector<State> states_;
    int inotify_ = -1, stop_ = -1;
    std::atomic<uint64_t> revision_{0};
    std::atomic<bool> prompt_{false};
    mutable std::mutex mutex_;
    std::vector<std::string> last_changed_;
    std::thread thread_;  // last: it sees the rest complete
};

}  // namespace clarity
