#include "api/mesh_scene.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "base/error.hpp"
#include "import/import.hpp"
#include "import/sink/world_origin.hpp"

namespace clarity::api {
namespace {

// Numbers of primitives are ints in kernels.
constexpr uint64_t kMost = std::numeric_limits<int32_t>::max();

// Rounds positions after the origin is subtracted that suits their box.
SharedArray<float> rounded(const double* positions, size_t numbers, std::array<double, 3>& origin) {
    import::WorldBox box;
    bool has_digits = false;
    for (size_t i = 0; i + 2 < numbers; i += 3) box.add({positions[i], positions[i + 1], positions[i + 2]});
    for (size_t i = 0; i < numbers && !has_digits; ++i) has_digits = positions[i] != double(float(positions[i]));
    if (box.is_far(has_digits ? import::kFarWithDigits : import::kFar)) origin = import::origin_of(box);
    std::vector<float> floats(numbers);
    for (size_t i = 0; i < numbers; ++i) floats[i] = static_cast<float>(positions[i] - origin[i % 3]);
    return floats;
}

}  // namespace

Scene scene_of_mesh(const PluginRegistry& plugins, const clarity_mesh& mesh) {
    const auto refuse = [](const std::string& why) { throw Error(Exit::usage, "the mesh of arrays " + why); };
    if (mesh.vertex_count > kMost || mesh.triangle_count > kMost)
        refuse("has more than 2^31 - 1 vertices or triangles: divide it");
    if ((!mesh.positions && mesh.vertex_count > 0) || (!mesh.triangles && mesh.triangle_count > 0))
        refuse("has a null pointer");
    if (mesh.type != CLARITY_FLOAT32 && mesh.type != CLARITY_FLOAT64)
        refuse("has positions of the unknown type " + std::to_string(mesh.type));
    Scene scene;
    const size_t numbers = 3 * mesh.vertex_count;
    if (mesh.type == CLARITY_FLOAT64)
        scene.positions = rounded(static_cast<const double*>(mesh.positions), numbers, scene.origin);
    else
        scene.positions = SharedArray<float>::borrow(nullptr, static_cast<const float*>(mesh.positions), numbers);
    scene.triangles = SharedArray<rt_u32>::borrow(nullptr, mesh.triangles, 3 * mesh.triangle_count);
    scene.triangle_materials.assign(mesh.triangle_count, 0);
    Mesh whole;
    whole.name = "mesh";
    whole.vertex_count = scene.vertex_count();
    whole.triangle_count = whole.polygon_count = scene.triangle_count();
    scene.meshes.push_back(whole);
    scene.instances.emplace_back();
    scene.instances.back().name = whole.name;
    scene.materials.push_back({"default", default_material()});
    if (const Problem why = import::complete_scene(plugins, scene)) refuse(why.text());
    return scene;
}

}  // namespace clarity::api
