#include "ui/browser/folder_reader.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <mutex>
#include <thread>

namespace clarity::ui {

struct FolderReader::Shared {
    std::mutex mutex;
    uint64_t asked = 0, done = 0;
    std::shared_ptr<const Listing> latest;
};

std::shared_ptr<const Listing> FolderReader::get(const DesiredListing& desired) {
    if (!shared_) shared_ = std::make_shared<Shared>();
    std::string key = desired.folder + (desired.files ? "\n" : "/\n");
    for (const std::string& extension : desired.extensions) key += extension + " ";
    const std::lock_guard<std::mutex> lock(shared_->mutex);
    if (key != asked_ || stale_) {
        asked_ = key;
        stale_ = false;
        const uint64_t number = ++shared_->asked;
        std::thread([shared = shared_, desired, number] {
            auto listing = std::make_shared<const Listing>(list_folder(desired));
            {
                const std::lock_guard<std::mutex> hold(shared->mutex);
                if (shared->asked != number) return;  // another folder was requested meanwhile
                shared->latest = std::move(listing);
                shared->done = number;
            }
            glfwPostEmptyEvent();  // wakes the window
        }).detach();
    }
    return shared_->latest;
}

bool FolderReader::reading() const {
    if (!shared_) return false;
    const std::lock_guard<std::mutex> lock(shared_->mutex);
    return shared_->done != shared_->asked;
}

}  // namespace clarity::ui
