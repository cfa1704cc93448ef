// file_access.hpp -- which files an import may read, and where a path in a model leads.
#pragma once
#include <string>
#include <vector>

namespace clarity::import {

// Throws Error(import_failed) "FILE: why" for what no importer could read: missing, unreadable, a folder, a device, empty,
// gzipped.
void check_model_file(const std::string& path);

// Models name other files: textures, included scenes. Only the folders of the files that the user named, and the search paths,
// are open to them; symbolic links are followed first and judged by where they lead.
class FileAccess {
 public:
    FileAccess(const std::vector<std::string>& files, const std::vector<std::string>& search_paths);

    // Canonical folders, without duplicates.
    const std::vector<std::string>& folders() const { return folders_; }

    struct Found {
        std::string path;  // canonical; empty if there is none
        std::string why;   // "no such file", "lies outside of ..."
    };
    // `path` as file `from` has it: relative to the folder of `from`, then to the search paths. Backslashes count as slashes.
    Found find(const std::string& from, const std::string& path) const;
    // As find; failing that, the bare file name beside `from`, in `textures` there, and in the search paths, since modelling
    // programs write paths of the machine that they ran on.
    Found find_texture(const std::string& from, const std::string& path) const;

 private:
    bool allowed(const std::string& canonical) const;
    std::vector<std::string> folders_;
    std::vector<std::string> search_;
};

}  // namespace clarity::import
