// scene_rows.hpp -- the scene as a flat list of filtered rows for the tree.
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace clarity::ui {

enum class RowKind { instance, sphere, polygon, plane, shape, mesh, material, light, camera };
inline constexpr int kRowKinds = 9;

// A row of the tree: an object, or the title of a kind of objects.
struct SceneRow {
    RowKind kind = RowKind::instance;
    int index = -1;    // -1: the title row of its kind
    size_t count = 0;  // in a title row: how many objects match
};

std::string row_name(const Scene& scene, RowKind kind, size_t index);
const char* kind_title(RowKind kind);
size_t row_count(const Scene& scene, RowKind kind);
// The material of a row's object; RT_NONE if it has none.
rt_u32 row_material(const Scene& scene, RowKind kind, size_t index);
// The number of a sphere, polygon, plane or shape among all primitives of the scene; -1 for other rows.
rt_i32 row_prim(const PrimNumbers& numbers, RowKind kind, size_t index);
// The material of the instance's first triangle; RT_NONE if it has no triangle.
rt_u32 instance_material(const Scene& scene, rt_u32 instance);

// A list of rows which is only made again when its inputs change.
class SceneRows {
 public:
    // open: the kinds of which rows are listed. With a filter, all kinds are listed.
    const std::vector<SceneRow>& update(const std::shared_ptr<const Scene>& scene, const std::string& filter,
                                        const std::array<bool, kRowKinds>& open);

 private:
    std::shared_ptr<const Scene> scene_;
    std::string filter_;
    std::array<bool, kRowKinds> open_{};
    std::vector<SceneRow> rows_;
};

}  // namespace clarity::ui
