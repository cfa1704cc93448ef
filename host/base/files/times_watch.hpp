// times_watch.hpp -- notices when files are saved, by their times and sizes. For files that are too large to be compared by
// their content, as FileWatch does.
#pragma once
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace clarity {

class TimesWatch {
 public:
    // Later states are compared with the present one, twice a second. A change counts once the files rest: while they are
    // written, or one of them is missing, it waits. changed: called on the watch's own thread; it must not destroy the watch.
    TimesWatch(std::vector<std::string> files, std::function<void()> changed);
    ~TimesWatch();
    TimesWatch(const TimesWatch&) = delete;
    TimesWatch& operator=(const TimesWatch&) = delete;

    uint64_t revision() const { return revision_; }  // number of changes so far
    std::string last_changed() const;                // a file that changed last

 private:
    struct State {
        int64_t modified_ns = 0;
        uint64_t bytes = 0, inode = 0;
        bool exists = false;
        bool operator!=(const State& b) const {
            return modified_ns != b.modified_ns || bytes != b.bytes || inode != b.inode || exists != b.exists;
        }
    };
    static State look(const std::string& path);
    void run();

    const std::vector<std::string> files_;
    const std::function<void()> changed_;
    std::vector<State> known_, seen_;  // as of the last change; as of the last look
    std::atomic<uint64_t> revision_{0};
    mutable std::mutex mutex_;
    std::condition_variable wake_;
    std::string last_changed_;
    bool stop_ = false;
    std::thread thread_;  // declared last: the thread uses all other members
};

}  // namespace clarity
