// file_listing.hpp -- what the file browser knows of folders. No window.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace clarity::ui {

struct FileEntry {
    std::string name;
    bool folder = false;
    uint64_t bytes = 0;
    int64_t modified_s = 0;  // since 1970; 0: not known
};

struct Listing {
    std::string folder;              // absolute
    std::vector<FileEntry> entries;  // folders first, then by name, whatever its case; no hidden ones
    std::string failure;             // why it could not be read
};

struct DesiredListing {
    std::string folder;
    std::vector<std::string> extensions;  // lower case, without dot, "ply.gz" allowed; empty: all
    bool files = true;                    // else folders only
};
// Never throws; may take a while.
Listing list_folder(const DesiredListing& desired);

// What is typed: "models/dra" looks for "dra" in the folder "models"; "~" is the home folder; a bare word looks in `folder`.
struct Typed {
    std::string folder, word;
};
Typed split_typed(const std::string& text, const std::string& folder);
std::string joined_path(const std::string& folder, const std::string& name);
std::string parent_folder(const std::string& folder);
std::string home_folder();
std::string absolute_folder(const std::string& folder);  // without a slash at its end

// Entries whose name has the word in it, those that begin with it first: indices into the listing.
std::vector<size_t> matching(const Listing& listing, const std::string& word);
// The text as far as it is certain: extended by what all entries that begin so have in common, and by "/" for a single folder.
std::string complete(const Listing& listing, const std::string& text);

}  // namespace clarity::ui
