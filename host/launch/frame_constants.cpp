#include "launch/frame_constants.hpp"

#include <cmath>
#include <cstring>

#include "scene/vec.hpp"
#include "view/settings/aov.hpp"

namespace clarity {
namespace {

bool normalize(Vec& v) {
    const double size = length(v);
    if (!(size > 0)) return false;
    for (double& x : v) x /= size;
    return true;
}

// The number of a choice, in the order of RT_BY_* or RT_FIRST_*. RT_NONE: it is none of them.
rt_u32 number_or_none(const std::string& chosen, const std::vector<const char*>& choices) {
    for (rt_u32 i = 0; i < choices.size(); ++i)
        if (chosen == choices[i]) return i;
    return RT_NONE;
}

}  // namespace

rt_frame make_frame(const View& view, const Settings& settings, const Layout& layout, const AccelData& accel, unsigned sample) {
    rt_frame frame{};
    const Camera& camera = view.camera;
    Vec w{double(camera.target[0]) - camera.eye[0], double(camera.target[1]) - camera.eye[1],
          double(camera.target[2]) - camera.eye[2]};
    const double camera_distance = length(w);
    if (!normalize(w)) w = {0, 0, -1};
    Vec up{camera.up[0], camera.up[1], camera.up[2]};
    Vec u = cross(w, up);
    if (!normalize(u)) {  // the camera looks along `up`: any perpendicular right will do
        u = cross(w, std::fabs(w[0]) < 0.9 ? Vec{1, 0, 0} : Vec{0, 0, 1});
        normalize(u);
    }
    const Vec v = cross(u, w);
    const double tangent = std::tan(0.5 * camera.fov_y_rad), aspect = double(settings.whole_width()) / settings.whole_height();
    for (int k = 0; k < 3; ++k) {
        frame.eye[k] = camera.eye[k];
        frame.forward[k] = static_cast<float>(w[k]);
        frame.right[k] = static_cast<float>(u[k] * tangent * aspect);
        frame.up[k] = static_cast<float>(v[k] * tangent);
        frame.background[k] = view.background[k];
        frame.ambient[k] = view.ambient[k];
    }
    frame.width = static_cast<rt_u32>(settings.width);
    frame.height = static_cast<rt_u32>(settings.height);
    frame.first_x = static_cast<rt_u32>(settings.crop.x);
    frame.first_y = static_cast<rt_u32>(settings.crop.y);
    frame.whole_width = static_cast<rt_u32>(settings.whole_width());
    frame.pixel_x = 1.0f / settings.whole_width();
    frame.pixel_y = 1.0f / settings.whole_height();
    frame.packet_w = layout.packet_w;
    frame.packet_h = layout.packet_h;
    frame.block_w = layout.block_w;
    while ((1u << frame.block_w_log2) < layout.block_w) ++frame.block_w_log2;
    frame.blocks_x = layout.blocks_x();
    frame.blocks_y = layout.blocks() / layout.blocks_x();
    frame.depth = static_cast<rt_u32>(settings.depth);
    frame.light_count = static_cast<rt_u32>(view.lights.size());
    frame.plane_count = static_cast<rt_u32>(accel.scene.planes.size());
    frame.sample = sample;
    frame.adds = sample > 0;
    frame.layers = 1;
    // Sample 0 is the pixel's centre. The others follow the R2 sequence (Roberts 2018, The Unreasonable Effectiveness of
    // Quasirandom Sequences); each prefix of it covers the pixel evenly.
    const double x = 0.5 + sample * 0.7548776662466927, y = 0.5 + sample * 0.5698402909980532;
    frame.within_x = static_cast<float>(x - std::floor(x));
    frame.within_y = static_cast<float>(y - std::floor(y));
    frame.samples = 1;
    rt_u32* number = frame.numbers;
    for (const Setting* row : kernel_numbers()) *number++ = row->bits(settings);
    if (settings.sampler == "sobol") frame.path_flags |= RT_PATH_SOBOL;
    if (settings.strategy != "bsdf") frame.path_flags |= RT_PATH_DRAWS_LIGHTS;
    if (settings.strategy != "nee") frame.path_flags |= RT_PATH_FINDS_LIGHTS;
    if (settings.mis == "power") frame.path_flags |= RT_PATH_POWER_WEIGHTS;
    if (settings.filter == "gaussian") frame.path_flags |= RT_PATH_GAUSSIAN;
    frame.only_by = number_or_none(settings.only_by, {"nee", "bsdf"});
    frame.only_first = number_or_none(settings.only_first, {"diffuse", "glossy", "transmission"});
    frame.focus = camera.focus > 0 ? camera.focus : static_cast<float>(camera_distance);
    frame.lens_x = static_cast<float>(0.5 * camera.aperture / (tangent * aspect));
    frame.lens_y = static_cast<float>(0.5 * camera.aperture / tangent);
    frame.shadows = settings.shadows;
    frame.aov = number_of(find_aov(settings.aov));
    frame.root = accel.roots.empty() ? 0 : accel.roots[0];
    const Bounds& bounds = accel.scene.bounds;
    for (int k = 0; k < 3; ++k) {
        frame.bounds[k] = bounds.empty ? INFINITY : bounds.min[k];
        frame.bounds[3 + k] = bounds.empty ? -INFINITY : bounds.max[k];
    }
    return frame;
}

}  // namespace clarity
