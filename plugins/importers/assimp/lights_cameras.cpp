#include "lights_cameras.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "../common/views.hpp"
#include "rt_plugin.hpp"

namespace assimp_import {
namespace {

using Vec = std::array<double, 3>;

// The n-th light (or camera) of a name belongs to the n-th node of that name.
class NodesOfNames {
 public:
    explicit NodesOfNames(const NodeTree& tree) : tree_(tree) {}
    Transform next(const aiString& name) {
        const std::string key(name.data, name.length);
        const PlacedNode* node = tree_.find(key, seen_[key]++);
        return node && is_finite(node->world) ? node->world : kIdentity;
    }

 private:
    const NodeTree& tree_;
    std::map<std::string, size_t> seen_;
};

// Scales the vector to unit length. Returns false, and changes nothing, if its length is 0 or not finite.
bool normalize(Vec& v) {
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (!(length > 1e-30) || !std::isfinite(length)) return false;
    for (double& x : v) x /= length;
    return true;
}

void store(const Vec& v, float out[3]) {
    for (int k = 0; k < 3; ++k) out[k] = static_cast<float>(v[k]);
}

bool all_finite(const float v[3]) {
    return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

std::string quoted(const aiString& name) {
    return "'" + std::string(name.data, name.length) + "'";
}

}  // namespace

void add_lights(const aiScene& scene, const NodeTree& tree, const rt_host& host, const rt_scene_sink& sink) {
    NodesOfNames placement(tree);
    importers::Lights lights;
    for (unsigned i = 0; i < scene.mNumLights; ++i) {
        const aiLight& light = *scene.mLights[i];
        const Transform world = placement.next(light.mName);
        if (light.mType == aiLightSource_AMBIENT) continue;
        rt_light_desc desc{};
        desc.struct_bytes = sizeof desc;
        if (light.mType == aiLightSource_DIRECTIONAL) {
            Vec direction = transform_vector(world, light.mDirection);
            if (!normalize(direction)) direction = {0, -1, 0};
            desc.kind = RT_LIGHT_DIRECTIONAL;
            store(direction, desc.direction);
        } else {
            const bool is_spot = light.mType == aiLightSource_SPOT;
            if (light.mType != aiLightSource_POINT && !is_spot)
                sink.warn(sink.ctx, ("the area light " + quoted(light.mName) + " became a point light").c_str());
            desc.kind = is_spot ? RT_LIGHT_SPOT : RT_LIGHT_POINT;
            Vec direction = transform_vector(world, light.mDirection);
            if (!normalize(direction)) direction = {0, -1, 0};
            store(direction, desc.direction);
            store(transform_point(world, light.mPosition), desc.position);
        }
        // Light that falls by 1 / (constant + linear d + quadratic d^2); a white surface that faces it is as bright as the
        // colour says where that is 1 (COLLADA 1.5, "point"). The square alone is an intensity of pi / quadratic.
        const double constant = light.mAttenuationConstant, linear = light.mAttenuationLinear,
                     quadratic = light.mAttenuationQuadratic;
        const bool is_far = desc.kind == RT_LIGHT_DIRECTIONAL, fades = !is_far && constant == 0 && linear == 0 && quadratic > 0;
        if (!is_far && !fades && (linear != 0 || quadratic != 0))
            sink.warn(sink.ctx, ("the light " + quoted(light.mName) +
                                 " has an attenuation other than by the square of the distance; "
                                 "here it lights all distances alike")
                                    .c_str());
        const double factor = fades ? 3.141592653589793 / quadratic : constant > 0 && !is_far ? 1 / constant : 1;
        const aiColor3D& c = light.mColorDiffuse;
        const importers::Cone cone = {light.mAngleOuterCone, light.mAngleInnerCone};  // whole angles
        if (all_finite(desc.position))
            lights.add(desc, light.mName.C_Str(), {c.r, c.g, c.b}, factor,
                       fades ? importers::Unit::physical : importers::Unit::relative, cone);
    }
    lights.pass(&host, sink);
}

void add_cameras(const aiScene& scene, const NodeTree& tree, const rt_scene_sink& sink) {
    NodesOfNames placement(tree);
    for (unsigned i = 0; i < scene.mNumCameras; ++i) {
        const aiCamera& camera = *scene.mCameras[i];
        const Transform world = placement.next(camera.mName);
        Vec forward = transform_vector(world, camera.mLookAt), up = transform_vector(world, camera.mUp);
        if (!normalize(forward)) forward = {0, 0, -1};
        if (!normalize(up)) up = {0, 1, 0};
        rt_camera out{};
        out.struct_bytes = sizeof out;
        out.name = camera.mName.C_Str();
        const Vec eye = transform_point(world, camera.mPosition);
        store(eye, out.eye);
        store({eye[0] + forward[0], eye[1] + forward[1], eye[2] + forward[2]}, out.target);
        store(up, out.up);
        if (!all_finite(out.eye) || !all_finite(out.target)) continue;
        // mHorizontalFOV is the whole angle, whatever the comment in its header says.
        const double aspect = camera.mAspect > 0 && std::isfinite(camera.mAspect) ? camera.mAspect : 4.0 / 3;
        const double fov_y = 2 * std::atan(std::tan(0.5 * camera.mHorizontalFOV) / aspect);
        out.fov_y_rad = importers::angle_of_view(fov_y, quoted(camera.mName), sink);
        rt::id(sink.camera(sink.ctx, &out));
    }
}

}  // namespace assimp_import
