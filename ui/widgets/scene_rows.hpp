// scene_rows.hpp -- the scene as a flat list of rows: what the tree shows, filtered, however large the scene is.
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace clarity::ui {

enum class RowKind { instance, sphere, polygon, plane, mesh, material, light, camera };
inline constexpr int kRowKinds = 8;

struct SceneRow {
    RowKind kind = RowKind::instance;
    int index = -1;    // -1: the title of its kind
    size_t count = 0;  // of a title: how many match
};

std::string row_name(const Scene& scene, RowKind kind, size_t index);
const char* kind_title(RowKind kind);
size_t row_count(const Scene& scene, RowKind kind);
// Material that an instance shows first; RT_NONE: it has no triangle.
rt_u32 instance_material(const Scene& scene, rt_u32 instance);
// Number of the first triangle of each instance among all of the world, then that of the first sphere.
std::vector<uint64_t> first_prims(const Scene& scene);

// Made anew only when what it is of changes.
class SceneRows {
 public:
    // open: kinds whose rows are listed; with a filter, all are.
    const std::vector<SceneRow>& update(const std::shared_ptr<const Scene>& scene, const std::string& filter,
                                        const std::array<bool, kRowKinds>& open);

 private:
    std::shared_ptr<const Scene> scene_;
    std::string filter_;
    std::array<bool, kRowKinds> open_{};
    std::vector<SceneRow> rows_;
};

}  // namespace clarity::ui
