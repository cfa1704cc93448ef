// file_access.hpp -- decides which files an import may read, and resolves the paths that a model contains.
#pragma once
#include <string>
#include <vector>

#include "import/import.hpp"

namespace clarity::import {

// Throws Error(import_failed) "FILE: why" if the file is missing, a folder, a device, or not readable.
void check_readable(const std::string& path);
// Also throws if no importer could use the content: the file is empty, or packed with gzip and damaged
// at its begin.
void check_model_file(const std::string& path);

// A model may name other files: textures and included scenes. It may only read from the folders of the files that the user
// named, and from the search paths. Symbolic links are resolved first; the target decides.
class FileAccess {
 public:
    // pictures: that the user named, too.
    FileAccess(const std::vector<std::string>& files, const std::vector<std::string>& search_paths,
               const std::vector<PictureFile>& pictures = {});

    // Canonical folders, without duplicates.
    const std::vector<std::string>& folders() const { return folders_; }

    struct Found {
        std::string path;  // canonical; empty if there is none
        std::string why;   // "no such file", "lies outside of ..."
    };
    // Resolves `path`, which stands in file `from`: first relative to the folder of `from`, then to the search paths.
    // Backslashes count as slashes.
    Found find(const std::string& from, const std::string& path) const;
    // Same as find(). If that fails, looks for the bare file name beside `from`, in its folder `textures`, and in the search
    // paths, because modelling programs write paths of the machine on which they ran.
    Found find_texture(const std::string& from, const std::string& path) const;

 private:
    bool allowed(const std::string& canonical) const;
    std::vector<std::string> folders_;
    std::vector<std::string> search_;
};

}  // namespace clarity::import
