// texture_path.hpp -- finds pictures by the paths that files of other machines hold. For importers.
#pragma once
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

namespace importers {

// A scene file's folder with a slash at its end, and its name without extension: "/models/", "car".
struct FilePlace {
    std::string folder, stem;
    explicit FilePlace(const std::string& path) {
        const size_t slash = path.find_last_of('/');
        folder = slash == path.npos ? "" : path.substr(0, slash + 1);
        const std::string name = path.substr(folder.size());
        stem = name.substr(0, name.find_last_of('.'));
    }
};

inline std::string with_slashes(std::string path) {
    std::replace(path.begin(), path.end(), '\\', '/');
    while (path.compare(0, 2, "./") == 0) path.erase(0, 2);
    return path;
}

// Files often hold paths of the author's machine. So this looks also in the places beside the scene where modelling programs
// put textures. Returns the first path, relative to the scene's folder, that can be read; otherwise the first of all. Empty:
// there is none.
inline std::string existing_picture(const FilePlace& scene, const std::vector<std::string>& paths) {
    std::vector<std::string> candidates;
    for (const std::string& given : paths) {
        const std::string path = with_slashes(given), name = path.substr(path.find_last_of('/') + 1);
        const bool is_absolute = !path.empty() && (path[0] == '/' || (path.size() > 1 && path[1] == ':'));
        if (!path.empty() && !is_absolute) candidates.push_back(path);
        if (name.empty()) continue;
        for (const std::string& folder : {std::string(), std::string("textures/"), scene.stem + ".fbm/"})
            candidates.push_back(folder + name);
    }
    for (const std::string& candidate : candidates) {
        FILE* file = std::fopen((scene.folder + candidate).c_str(), "rb");
        if (!file) continue;
        std::fclose(file);
        return candidate;
    }
    return candidates.empty() ? "" : candidates.front();
}

}  // namespace importers
