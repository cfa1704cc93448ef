// file_listing.hpp -- folder listings and path completion for the file browser. Needs no window.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace clarity::ui {

struct FileEntry {
    std::string name;
    bool folder = false;
    uint64_t bytes = 0;
    int64_t modified_s = 0;  // seconds since 1970; 0: not known
};

// The contents of a folder.
struct Listing {
    std::string folder;              // absolute
    std::vector<FileEntry> entries;  // folders first, then by name without regard to case; without hidden ones
    std::string failure;             // why the folder could not be read; empty: it was
};

// Which folder to list, and which of its entries.
struct DesiredListing {
    std::string folder;
    std::vector<std::string> extensions;  // lower case, without the dot, "ply.gz" allowed; empty: all files
    bool files = true;                    // false: folders only
};
// Reads a folder. Never throws; may block on a slow disk.
Listing list_folder(const DesiredListing& desired);

// The parts of typed text: "models/dra" searches for "dra" in the folder "models"; "~" is the home folder; a single word
// searches in `folder`.
struct Typed {
    std::string folder, word;
};
Typed split_typed(const std::string& text, const std::string& folder);
std::string joined_path(const std::string& folder, const std::string& name);
std::string parent_folder(const std::string& folder);
std::string home_folder();
std::string absolute_folder(const std::string& folder);  // without a slash at its end

// Returns the indices of the entries with `word` in their names; names that begin with it come first.
std::vector<size_t> matching(const Listing& listing, const std::string& word);
// Completes the text: appends what all entries that begin with it have in common, and "/" for a single folder.
std::string complete(const Listing& listing, const std::string& text);

// Reads folders on detached threads. A read that hangs is abandoned.

// Keeps the listing of the folder that was requested last. Used on the window's thread; get() never waits for a disk.
class FolderReader {
 public:
    // Returns the newest listing, which may be of another folder while reading(). nullptr until the first.
    std::shared_ptr<const Listing> get(const DesiredListing& desired);
    bool reading() const;
    // From now on no thread wakes the window, which may go then.
    void stop();
    // The next get() reads the folder again.
    void refresh() { stale_ = true; }

 private:
    struct Shared;
    std::shared_ptr<Shared> shared_;
    std::string asked_;
    bool stale_ = false;
};

}  // namespace clarity::ui
