#include "view/camera_path.hpp"

#include <algorithm>
#include <cmath>

#include "base/numbers.hpp"
#include "scene/camera.hpp"
#include "scene/motion/matrix.hpp"
#include "view/settings/settings.hpp"
#include "view/view.hpp"

namespace clarity {
namespace {

constexpr double kSameTime = 5e-4;  // seconds
constexpr const char* kExpected =
    "keys t:ex,ey,ez,tx,ty,tz,fov_degrees,ux,uy,uz by growing times, with semicolons between them";

Vec normalized_or(const Vec& a, const Vec& otherwise) {
    const double size = length(a);
    return size > 0 ? (1 / size) * a : otherwise;
}

// A camera as a rotation of one that looks along -z with y up.
Quaternion orientation(const Camera& camera) {
    const Vec w = normalized_or(to_vec(camera.target) - to_vec(camera.eye), {0, 0, -1});
    Vec u = cross(w, to_vec(camera.up));
    if (!(length(u) > 0)) u = cross(w, std::fabs(w[0]) < 0.9 ? Vec{1, 0, 0} : Vec{0, 0, 1});
    u = normalized(u);
    const Vec v = cross(u, w);
    return quaternion_of({u[0], v[0], -w[0], 0, u[1], v[1], -w[1], 0, u[2], v[2], -w[2], 0});
}

double distance(const Camera& camera) {
    return length(to_vec(camera.target) - to_vec(camera.eye));
}

Camera between(const Camera& a, const Camera& b, double x) {
    Camera camera = a;
    camera.name.clear();
    const Matrix turn = rotation(slerp(orientation(a), orientation(b), x));
    const Vec eye = (1 - x) * to_vec(a.eye) + x * to_vec(b.eye);
    const double far = (1 - x) * distance(a) + x * distance(b);
    camera.eye = to_floats(eye);
    camera.target = to_floats(eye + direction(turn, {0, 0, -far}));
    camera.up = to_floats(direction(turn, {0, 1, 0}));
    const auto mix = [x](float from, float to) { return static_cast<float>((1 - x) * double(from) + x * double(to)); };
    camera.fov_y_rad = mix(a.fov_y_rad, b.fov_y_rad);
    camera.aperture = mix(a.aperture, b.aperture);
    camera.focus = mix(a.focus, b.focus);
    return camera;
}

std::string three(const std::array<float, 3>& v) {
    return exact_text(v[0]) + " " + exact_text(v[1]) + " " + exact_text(v[2]);
}

// An axis and degrees, as `rotate` reads them.
std::string turn_text(const Quaternion& q) {
    const double sign = q[3] < 0 ? -1 : 1, s = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    if (!(s > 1e-12)) return "0 1 0 0";
    const double degrees = 2 * std::atan2(s, sign * q[3]) / kRadPerDegree;
    return three(to_floats((sign / s) * Vec{q[0], q[1], q[2]})) + " " + exact_text(static_cast<float>(degrees));
}

CameraKey read_key(const std::string& text, const std::string& all, const std::array<double, 3>& origin) {
    const size_t colon = text.find(':');
    CameraKey key;
    if (colon == std::string::npos || !read_number(text.substr(0, colon), key.time_s))
        refuse_value("camera_path", all, kExpected);
    const std::optional<CameraNumbers> numbers = read_camera_numbers(text.substr(colon + 1));
    if (!numbers || !numbers->up || !(*numbers->fov_deg > 0 && *numbers->fov_deg < 180))
        refuse_value("camera_path", all, kExpected);
    key.camera.eye = scene_point(numbers->eye, origin);
    key.camera.target = scene_point(numbers->target, origin);
    key.camera.fov_y_rad = static_cast<float>(*numbers->fov_deg * kRadPerDegree);
    key.camera.up = *numbers->up;
    key.camera.aperture = numbers->aperture;
    key.camera.focus = numbers->focus;
    return key;
}

}  // namespace

bool CameraKey::operator==(const CameraKey& b) const {
    return time_s == b.time_s && same_camera(camera, b.camera);
}

Camera CameraPath::at(double time_s) const {
    const auto later = [](double time, const CameraKey& key) { return time < key.time_s; };
    const auto next = std::upper_bound(keys.begin(), keys.end(), time_s, later);
    if (next == keys.begin()) return next->camera;
    const CameraKey& from = *(next - 1);
    if (next == keys.end() || time_s == from.time_s) return from.camera;
    return between(from.camera, next->camera, (time_s - from.time_s) / (next->time_s - from.time_s));
}

int CameraPath::key_at(double time_s) const {
    for (size_t i = 0; i < keys.size(); ++i)
        if (std::fabs(keys[i].time_s - time_s) < kSameTime) return static_cast<int>(i);
    return -1;
}

void CameraPath::set(double time_s, const Camera& camera) {
    CameraKey key{time_s, camera};
    key.camera.name.clear();
    key.camera.node = RT_NONE;
    if (const int known = key_at(time_s); known >= 0) {
        keys[static_cast<size_t>(known)].camera = key.camera;
        return;
    }
    const auto later = [](double time, const CameraKey& k) { return time < k.time_s; };
    keys.insert(std::upper_bound(keys.begin(), keys.end(), time_s, later), key);
}

std::string path_text(const CameraPath& path, const std::array<double, 3>& origin) {
    std::string text;
    for (const CameraKey& key : path.keys)
        text += (text.empty() ? "" : ";") + exact_text(key.time_s) + ":" + camera_text(key.camera, origin);
    return text;
}

CameraPath read_path(const std::string& text, const std::array<double, 3>& origin) {
    CameraPath path;
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find(';', at), text.size());
        path.keys.push_back(read_key(text.substr(at, end - at), text, origin));
        if (path.keys.size() > 1 && !(path.keys.back().time_s > path.keys[path.keys.size() - 2].time_s))
            refuse_value("camera_path", text, kExpected);
        at = end + 1;
    }
    return path;
}

std::string animate_lines(const CameraPath& path, const std::string& name, const std::array<double, 3>& origin) {
    if (path.empty()) return {};
    const Camera& first = path.keys.front().camera;
    const Quaternion at_first = orientation(first);
    const Quaternion back = {-at_first[0], -at_first[1], -at_first[2], at_first[3]};
    std::string moves, turns, angles;
    bool zooms = false;
    for (const CameraKey& key : path.keys) {
        const std::string time = exact_text(static_cast<float>(key.time_s));
        moves += "  " + time + " " + point_text(key.camera.eye.data(), origin, " ");
        turns += "  " + time + " " + turn_text(orientation(key.camera) * back);
        angles += "  " + time + " " + exact_text(static_cast<float>(key.camera.fov_y_rad / kRadPerDegree));
        zooms = zooms || key.camera.fov_y_rad != first.fov_y_rad;
    }
    std::string lines = "camera " + name + " eye " + point_text(first.eye.data(), origin, " ") + " target " +
                        point_text(first.target.data(), origin, " ") + " up " + three(first.up) + " fov " +
                        exact_text(static_cast<float>(first.fov_y_rad / kRadPerDegree)) + lens_words(first) + "\n";
    lines += "animate " + name + " translate" + moves + "\nanimate " + name + " rotate" + turns + "\n";
    if (zooms) lines += "animate " + name + " fov" + angles + "\n";
    return lines;
}

}  // namespace clarity
