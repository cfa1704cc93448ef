// folder_reader.hpp -- reads folders on threads that nobody waits for: one that hangs is left behind.
#pragma once
#include <memory>
#include <string>

#include "ui/browser/file_listing.hpp"

namespace clarity::ui {

class FolderReader {
 public:
    // The newest listing there is, which may be of another folder while `reading`; nullptr at first.
    std::shared_ptr<const Listing> get(const DesiredListing& desired);
    bool reading() const;
    // The next get() reads anew.
    void refresh() { stale_ = true; }

 private:
    struct Shared;
    std::shared_ptr<Shared> shared_;
    std::string asked_;
    bool stale_ = false;
};

}  // namespace clarity::ui
