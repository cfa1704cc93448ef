#include "ui/widgets/scene_rows.hpp"

#include <iterator>

#include "ui/widgets/formats.hpp"

namespace clarity::ui {
namespace {

const std::string& own_name(const Scene& scene, RowKind kind, size_t index) {
    static const std::string none;
    switch (kind) {
        case RowKind::instance:
            return scene.instances[index].name.empty() ? scene.meshes[scene.instances[index].mesh].name
                                                       : scene.instances[index].name;
        case RowKind::mesh:
            return scene.meshes[index].name;
        case RowKind::material:
            return scene.materials[index].name;
        case RowKind::light:
            return scene.lights[index].name;
        case RowKind::camera:
            return scene.cameras[index].name;
        default:
            return none;
    }
}

struct Kind {
    RowKind kind;
    const char *title, *noun;
    size_t (*count)(const Scene& scene);
};
constexpr Kind kKinds[] = {
    {RowKind::instance, "Instances", "instance", [](const Scene& scene) { return scene.instances.size(); }},
    {RowKind::sphere, "Spheres", "sphere", [](const Scene& scene) { return scene.spheres.size(); }},
    {RowKind::polygon, "Polygons", "polygon", [](const Scene& scene) { return scene.polygons.size(); }},
    {RowKind::plane, "Planes", "plane", [](const Scene& scene) { return scene.planes.size(); }},
    {RowKind::shape, "Shapes", "shape", [](const Scene& scene) { return scene.shapes.size(); }},
    {RowKind::mesh, "Meshes", "mesh", [](const Scene& scene) { return scene.meshes.size(); }},
    {RowKind::material, "Materials", "material", [](const Scene& scene) { return scene.materials.size(); }},
    {RowKind::light, "Lights", "light", [](const Scene& scene) { return scene.lights.size(); }},
    {RowKind::camera, "Cameras", "camera", [](const Scene& scene) { return scene.cameras.size(); }},
};
constexpr bool in_order() {
    for (int i = 0; i < kRowKinds; ++i)
        if (kKinds[i].kind != static_cast<RowKind>(i)) return false;
    return true;
}
static_assert(std::size(kKinds) == kRowKinds && in_order());
const Kind& row_of(RowKind kind) {
    return kKinds[static_cast<int>(kind)];
}

}  // namespace

const char* kind_title(RowKind kind) {
    return row_of(kind).title;
}

size_t row_count(const Scene& scene, RowKind kind) {
    return row_of(kind).count(scene);
}

std::string row_name(const Scene& scene, RowKind kind, size_t index) {
    if (kind == RowKind::shape)  // "torus 3"; shapes of all kinds are counted together
        return scene.shape_kinds[scene.shapes[index].kind].id + " " + std::to_string(index);
    const std::string& name = own_name(scene, kind, index);
    return name.empty() ? std::string(row_of(kind).noun) + " " + std::to_string(index) : name;
}

rt_u32 row_material(const Scene& scene, RowKind kind, size_t index) {
    switch (kind) {
        case RowKind::instance:
            return instance_material(scene, static_cast<rt_u32>(index));
        case RowKind::sphere:
            return scene.spheres[index].material;
        case RowKind::polygon:
            return scene.polygons[index].material;
        case RowKind::plane:
            return scene.planes[index].material;
        case RowKind::shape:
            return scene.shapes[index].material;
        case RowKind::material:
            return static_cast<rt_u32>(index);
        default:
            return RT_NONE;
    }
}

rt_i32 row_prim(const PrimNumbers& numbers, RowKind kind, size_t index) {
    using Kind = PrimPlace::Kind;
    static_assert(int(RowKind::shape) - int(RowKind::sphere) == int(Kind::shape) - int(Kind::sphere),
                  "the same kinds in one order");
    if (kind < RowKind::sphere || kind > RowKind::shape) return -1;
    const auto prims = static_cast<Kind>(int(kind) - int(RowKind::sphere) + int(Kind::sphere));
    return static_cast<rt_i32>(numbers.first(prims) + index);
}

rt_u32 instance_material(const Scene& scene, rt_u32 instance) {
    const Instance& placed = scene.instances[instance];
    if (placed.material != RT_NONE) return placed.material;
    const Mesh& mesh = scene.meshes[placed.mesh];
    return mesh.triangle_count > 0 ? scene.triangle_materials[mesh.first_triangle] : RT_NONE;
}

const std::vector<SceneRow>& SceneRows::update(const std::shared_ptr<const Scene>& scene, const std::string& filter,
                                               const std::array<bool, kRowKinds>& open) {
    if (scene == scene_ && filter == filter_ && open == open_) return rows_;
    scene_ = scene;
    filter_ = filter;
    open_ = open;
    rows_.clear();
    if (!scene) return rows_;
    const bool all = matches({}, filter);
    for (int k = 0; k < kRowKinds; ++k) {
        const auto kind = static_cast<RowKind>(k);
        const size_t count = row_count(*scene, kind), title = rows_.size();
        if (count == 0) continue;
        rows_.push_back({kind, -1, count});
        if (all && !open[static_cast<size_t>(k)]) continue;
        for (size_t i = 0; i < count; ++i)
            if (all || matches(row_name(*scene, kind, i), filter)) rows_.push_back({kind, static_cast<int>(i), 0});
        rows_[title].count = rows_.size() - title - 1;
        if (rows_[title].count == 0) rows_.pop_back();
    }
    return rows_;
}

}  // namespace clarity::ui
