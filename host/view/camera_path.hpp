// camera_path.hpp -- a camera that moves from key to key, as the user sets them on the timeline.
//
// Between two keys the eye moves straight and evenly, and the camera turns evenly along the shorter arc, as `animate` of a text
// scene moves a camera. Outside of the keys the camera rests.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace clarity {

struct CameraKey {
    double time_s = 0;  // on the clip's clock
    Camera camera;
    bool operator==(const CameraKey& b) const;
};

struct CameraPath {
    std::vector<CameraKey> keys;  // by growing times

    bool empty() const { return keys.empty(); }
    // The camera at a time; there must be a key.
    Camera at(double time_s) const;
    // Sets a key, or replaces the one at this time.
    void set(double time_s, const Camera& camera);
    // The number of the key at this time, to a thousandth of a second; -1: there is none.
    int key_at(double time_s) const;
    bool operator==(const CameraPath& b) const { return keys == b.keys; }
};

// "0:ex,ey,ez,tx,ty,tz,fov_deg,ux,uy,uz;1.5:...": the value of the edit `camera_path`, with all digits.
std::string path_text(const CameraPath& path, const std::array<double, 3>& origin = {});
// Throws Error(usage), which says what was read and what is allowed. An empty text is a path without keys.
CameraPath read_path(const std::string& text, const std::array<double, 3>& origin = {});

// The lines of a text scene for a camera of this name which follows the path: `camera` and `animate`. Empty for a path without
// keys.
std::string animate_lines(const CameraPath& path, const std::string& name, const std::array<double, 3>& origin = {});

}  // namespace clarity
