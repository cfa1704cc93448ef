// folder_reader.hpp -- reads folders on detached threads. A read that hangs is abandoned.
#pragma once
#include <memory>
#include <string>

#include "ui/browser/file_listing.hpp"

namespace clarity::ui {

// Keeps the listing of the folder that was requested last. Used on the window's thread; get() never waits for a disk.
class FolderReader {
 public:
    // Returns the newest listing, which may be of another folder while reading(). nullptr until the first.
    std::shared_ptr<const Listing> get(const DesiredListing& desired);
    bool reading() const;
    // The next get() reads the folder again.
    void refresh() { stale_ = true; }

 private:
    struct Shared;
    std::shared_ptr<Shared> shared_;
    std::string asked_;
    bool stale_ = false;
};

}  // namespace clarity::ui
