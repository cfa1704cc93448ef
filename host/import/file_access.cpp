#include "import/file_access.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "base/error.hpp"
#include "base/files/packed_file.hpp"

namespace clarity::import {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
    throw Error(Exit::import_failed, path + ": " + why);
}

// Canonical path of `path`; empty if it cannot be resolved.
std::string canonical_or_empty(const fs::path& path) {
    std::error_code error;
    const fs::path real = fs::canonical(path, error);
    return error ? std::string() : real.string();
}

std::string with_slashes(std::string path) {
    std::replace(path.begin(), path.end(), '\\', '/');
    return path;
}

fs::path folder_of(const std::string& file) {
    const fs::path folder = fs::path(file).parent_path();
    return folder.empty() ? fs::path(".") : folder;
}

void add_unique(std::vector<std::string>& list, const std::string& item) {
    if (!item.empty() && std::find(list.begin(), list.end(), item) == list.end()) list.push_back(item);
}

}  // namespace

void check_readable(const std::string& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (status.type() == fs::file_type::not_found) refuse(path, "no such file");
    if (error) refuse(path, "cannot be read: " + error.message());
    if (fs::is_directory(status)) refuse(path, "is a folder; name a model file in it");
    if (!fs::is_regular_file(status)) refuse(path, "is no regular file; save what it delivers to a file first");
    if (access(path.c_str(), R_OK) != 0) refuse(path, std::string("cannot be read: ") + std::strerror(errno));
}

void check_model_file(const std::string& path) {
    check_readable(path);
    std::error_code error;
    if (fs::file_size(path, error) == 0) refuse(path, "the file is empty");
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    char first;
    if (!file || !file.get(first)) refuse(path, std::string("cannot be read: ") + std::strerror(errno != 0 ? errno : EIO));
    if (is_packed(path)) {
        std::string head;
        const Problem why = unpack_head(path, 1, head);
        if (why && head.empty()) refuse(path, why.text());
        if (head.empty()) refuse(path, "is packed with gzip, and nothing is in it");
    } else if (name_without_gz(path) != path) {
        refuse(path, "is no gzip file, as its name says: its first bytes are others; copy it again, or name it without .gz");
    }
}

FileAccess::FileAccess(const std::vector<std::string>& files, const std::vector<std::string>& search_paths,
                       const std::vector<PictureFile>& pictures) {
    for (const std::string& file : files) add_unique(folders_, canonical_or_empty(folder_of(file)));
    for (const PictureFile& picture : pictures) add_unique(folders_, canonical_or_empty(folder_of(picture.path)));
    for (const std::string& path : search_paths) {
        const std::string folder = canonical_or_empty(path);
        if (folder.empty()) throw Error(Exit::usage, path + ": search path: no such folder");
        add_unique(search_, folder);
        add_unique(folders_, folder);
    }
}

bool FileAccess::allowed(const std::string& canonical) const {
    for (const std::string& folder : folders_) {
        if (folder == "/") return true;
        if (canonical.size() > folder.size() && canonical.compare(0, folder.size(), folder) == 0 &&
            canonical[folder.size()] == '/') {
            return true;
        }
    }
    return false;
}

FileAccess::Found FileAccess::find(const std::string& from, const std::string& path) const {
    const fs::path wanted = with_slashes(path);
    if (wanted.empty()) return {{}, "no file name given"};
    std::vector<fs::path> tries = {folder_of(from) / wanted};  // an absolute `wanted` replaces the folder
    for (const std::string& folder : search_) tries.push_back(folder / wanted);
    std::string why = "no such file";
    for (const fs::path& place : tries) {
        const std::string real = canonical_or_empty(place);
        if (real.empty()) continue;
        if (allowed(real)) return {real, {}};
        why = "it lies outside of the scene's own folder and of the search paths, so it is not read";
    }
    return {{}, why};
}

FileAccess::Found FileAccess::find_texture(const std::string& from, const std::string& path) const {
    Found found = find(from, path);
    const fs::path name = fs::path(with_slashes(path)).filename();
    if (!found.path.empty() || name.empty()) return found;
    for (const fs::path& place : {name, fs::path("textures") / name}) {
        const Found beside = find(from, place.string());
        if (!beside.path.empty()) return beside;
    }
    return found;
}

}  // namespace clarity::import
