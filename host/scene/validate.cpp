// validate.cpp -- checks whether a scene is sound, in linear time. The hot loops are reductions that the compiler vectorises;
// only after one fails is its array searched for the first bad element.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "base/angle.hpp"
#include "base/problem.hpp"
#include "scene/bright_texture.hpp"
#include "scene/light_kinds.hpp"
#include "scene/material_keys.hpp"

namespace clarity {
namespace {

bool all_finite(const float* values, size_t count) {
    uint32_t bad = 0;
    for (size_t i = 0; i < count; ++i) {
        uint32_t bits;
        std::memcpy(&bits, values + i, sizeof bits);
        bad |= static_cast<uint32_t>((bits & 0x7F800000u) == 0x7F800000u);
    }
    return bad == 0;
}
template <class Array>
bool all_finite(const Array& values) {
    return all_finite(std::data(values), std::size(values));
}

std::string text(const char* what, uint64_t index, const std::string& why) {
    return std::string(what) + " " + std::to_string(index) + ": " + why;
}
std::string of(uint64_t index, uint64_t count) {
    return std::to_string(index) + " of " + std::to_string(count);
}

Problem check_arrays(const Scene& s) {
    const size_t vertices = s.positions.size() / 3;
    if (s.positions.size() % 3 != 0) return "positions: " + std::to_string(s.positions.size()) + " numbers, not 3 per vertex";
    if (vertices >= RT_NONE) return "positions: " + std::to_string(vertices) + " vertices are more than an index can name";
    if (!s.normals.empty() && s.normals.size() != s.positions.size()) return "normals: not 3 numbers per vertex";
    if (!s.uvs.empty() && s.uvs.size() != 2 * vertices) return "uvs: not 2 numbers per vertex";
    if (!s.uvs2.empty() && s.uvs2.size() != 2 * vertices) return "uvs2: not 2 numbers per vertex";
    if (!s.colors.empty() && s.colors.size() != 4 * vertices) return "colors: not 4 numbers per vertex";
    if (s.triangles.size() % 3 != 0) return "triangles: " + std::to_string(s.triangles.size()) + " indices, not 3 per triangle";
    if (!s.tangents.empty() && s.tangents.size() != s.triangles.size()) return "tangents: not 3 per triangle";
    if (s.triangle_materials.size() != s.triangles.size() / 3) return "triangle materials: not one per triangle";
    if (s.polygon_corners.size() % 3 != 0) return "polygon corners: not 3 numbers per corner";
    // A ref stores the index within its kind in 28 bits.
    for (const size_t count :
         {s.triangles.size() / 3, s.instances.size(), s.spheres.size(), s.polygons.size(), s.shape_parts.size()}) {
        if (count > RT_REF_INDEX_MAX) return std::to_string(count) + " primitives of one kind are more than a ref can name";
    }
    const auto check = [](const char* what, const auto& values, uint64_t per_element) {
        if (all_finite(values)) return Problem();
        const auto bad = std::find_if(values.begin(), values.end(), [](float x) { return !std::isfinite(x); });
        return Problem(text(what, static_cast<uint64_t>(bad - values.begin()) / per_element, "not a finite number"));
    };
    if (Problem why = check("position", s.positions, 3)) return why;
    if (Problem why = check("normal", s.normals, 3)) return why;
    if (Problem why = check("uv", s.uvs, 2)) return why;
    if (Problem why = check("uv2", s.uvs2, 2)) return why;
    if (Problem why = check("color", s.colors, 4)) return why;
    return check("polygon corner", s.polygon_corners, 3);
}

Problem check_meshes(const Scene& s) {
    const uint64_t vertices = s.positions.size() / 3, triangles = s.triangles.size() / 3;
    for (size_t i = 0; i < s.meshes.size(); ++i) {
        const Mesh& m = s.meshes[i];
        if (uint64_t(m.first_vertex) + m.vertex_count > vertices)
            return text("mesh", i, "its vertices reach past the last one");
        if (uint64_t(m.first_triangle) + m.triangle_count > triangles)
            return text("mesh", i, "its triangles reach past the last one");
        const rt_u32* v = s.triangles.data() + 3 * size_t(m.first_triangle);
        const size_t corners = 3 * size_t(m.triangle_count);
        rt_u32 outside = 0;
        for (size_t k = 0; k < corners; ++k) outside |= static_cast<rt_u32>(v[k] - m.first_vertex >= m.vertex_count);
        if (outside == 0) continue;
        const rt_u32* bad = std::find_if(v, v + corners, [&](rt_u32 x) { return x - m.first_vertex >= m.vertex_count; });
        return text("triangle", m.first_triangle + static_cast<uint64_t>(bad - v) / 3,
                    "vertex " + std::to_string(*bad) + " is not of its mesh (" + std::to_string(m.first_vertex) + " to " +
                        std::to_string(uint64_t(m.first_vertex) + m.vertex_count) + ")");
    }
    rt_u32 highest = 0;
    for (const rt_u32 v : s.triangles) highest = std::max(highest, v);
    if (!s.triangles.empty() && highest >= vertices) {
        const auto bad = std::find_if(s.triangles.begin(), s.triangles.end(), [&](rt_u32 v) { return v >= vertices; });
        return text("triangle", static_cast<uint64_t>(bad - s.triangles.begin()) / 3, "vertex " + of(*bad, vertices));
    }
    rt_u32 material = 0;
    for (const rt_u32 m : s.triangle_materials) material = std::max(material, m);
    if (!s.triangle_materials.empty() && material >= s.materials.size()) {
        return "triangle materials: material " + of(material, s.materials.size());
    }
    for (size_t i = 0; i < s.instances.size(); ++i) {
        const Instance& instance = s.instances[i];
        if (instance.mesh >= s.meshes.size()) return text("instance", i, "mesh " + of(instance.mesh, s.meshes.size()));
        if (instance.material != RT_NONE && instance.material >= s.materials.size()) {
            return text("instance", i, "material " + of(instance.material, s.materials.size()));
        }
        if (!all_finite(instance.world_from_object)) return text("instance", i, "its transform is not finite");
        const InstanceShift& shift = instance.shift;
        for (const auto* numbers : {&shift.translate, &shift.degrees, &shift.scale, &instance.pivot})
            if (!all_finite(*numbers)) return text("instance", i, "what moves it is not finite");
    }
    return {};
}

Problem check_analytic(const Scene& s) {
    const auto bad_material = [&](rt_u32 m) { return m >= s.materials.size(); };
    for (size_t i = 0; i < s.spheres.size(); ++i) {
        const Sphere& sphere = s.spheres[i];
        if (!all_finite(sphere.center)) return text("sphere", i, "its centre is not finite");
        if (!std::isfinite(sphere.radius) || sphere.radius < 0) return text("sphere", i, "its radius is not a positive number");
        if (bad_material(sphere.material)) return text("sphere", i, "material " + of(sphere.material, s.materials.size()));
    }
    for (size_t i = 0; i < s.planes.size(); ++i) {
        const Plane& plane = s.planes[i];
        const float* n = plane.normal.data();
        const float squared = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        if (!(std::abs(squared - 1) < 1e-3f)) return text("plane", i, "its normal is not of unit length");
        if (!std::isfinite(plane.offset)) return text("plane", i, "its offset is not finite");
        if (bad_material(plane.material)) return text("plane", i, "material " + of(plane.material, s.materials.size()));
    }
    const uint64_t corners = s.polygon_corners.size() / 3;
    for (size_t i = 0; i < s.polygons.size(); ++i) {
        const Polygon& polygon = s.polygons[i];
        if (polygon.corner_count < 3) return text("polygon", i, "fewer than three corners");
        if (uint64_t(polygon.first_corner) + polygon.corner_count > corners)
            return text("polygon", i, "corners past the last one");
        if (bad_material(polygon.material)) return text("polygon", i, "material " + of(polygon.material, s.materials.size()));
    }
    return {};
}

Problem check_shapes(const Scene& s) {
    for (size_t i = 0; i < s.shape_parts.size(); ++i) {
        const ShapePart& part = s.shape_parts[i];
        if (!all_finite(part.min) || !all_finite(part.max) || !all_finite(part.numbers))
            return text("part of a shape", i, "not a finite number");
        for (int k = 0; k < 3; ++k)
            if (part.min[k] > part.max[k]) return text("part of a shape", i, "its box is inside out");
        if (uint64_t(part.first_more) + part.more_count > s.shape_numbers.size())
            return text("part of a shape", i, "numbers past the last one");
    }
    if (!all_finite(s.shape_numbers)) return "numbers of shapes: not a finite number";
    uint64_t placed = 0;
    for (size_t i = 0; i < s.shapes.size(); ++i) {
        const Shape& shape = s.shapes[i];
        if (shape.kind >= s.shape_kinds.size()) return text("shape", i, "kind " + of(shape.kind, s.shape_kinds.size()));
        if (uint64_t(shape.first_part) + shape.part_count > s.shape_parts.size())
            return text("shape", i, "parts past the last one");
        if (shape.material >= s.materials.size()) return text("shape", i, "material " + of(shape.material, s.materials.size()));
        if (!all_finite(shape.world_from_object)) return text("shape", i, "its transform is not finite");
        placed += shape.part_count;
    }
    if (placed > RT_REF_INDEX_MAX) return std::to_string(placed) + " parts of shapes are more than a ref can name";
    return {};
}

Problem check_looks(const Scene& s) {
    if (s.materials.empty()) return "materials: the default material is missing";
    for (size_t i = 0; i < s.materials.size(); ++i) {
        const rt_material& m = s.materials[i].values;
        if (const Problem fault = material_fault(m)) return text("material", i, fault.text());
        if (m.texture != RT_NONE && m.texture >= s.textures.size()) {
            return text("material", i, "texture " + of(m.texture, s.textures.size()));
        }
        for (const rt_u32 map : s.materials[i].maps)
            if (map != RT_NONE && map >= s.maps.size()) return text("material", i, "map " + of(map, s.maps.size()));
    }
    for (size_t i = 0; i < s.maps.size(); ++i) {
        const rt_map& m = s.maps[i];
        if (m.texture >= s.textures.size()) return text("map", i, "texture " + of(m.texture, s.textures.size()));
        if (m.set > 1) return text("map", i, "set " + std::to_string(m.set) + " of texture coordinates");
        if (!std::isfinite(m.scale) || !std::all_of(m.matrix, m.matrix + 6, [](float x) { return std::isfinite(x); }))
            return text("map", i, "not a finite number");
    }
    for (size_t i = 0; i < s.textures.size(); ++i) {
        const rt_texture& t = s.textures[i];
        const uint64_t texels = texel_count(t);
        if (texels == 0) return text("texture", i, "it is empty");
        if (texels > s.texels.size() || t.first > s.texels.size() - texels)
            return text("texture", i, "texels past the last one");
        if (t.wrap % RT_WRAP_ALONG_V > RT_WRAP_MIRROR || t.wrap / RT_WRAP_ALONG_V > RT_WRAP_MIRROR)
            return text("texture", i, "unknown wrap modes");
        if (t.flags & ~(RT_TEXTURE_LINEAR | RT_TEXTURE_NEAREST | kBrightTexture | (is_bright(t) ? kBrightPower : 0)))
            return text("texture", i, "unknown flags");
    }
    return {};
}

Problem check_sky(const Scene& s) {
    const SkyValues& sky = s.sky.values;
    if (sky.kind != RT_NONE && sky.kind >= RT_SKY_KINDS) return "sky: unknown kind";
    const bool picture = sky.kind == RT_SKY_PICTURE;
    if (picture && (sky.width == 0 || sky.height == 0)) return "sky: its picture is empty";
    if (s.sky.texels.size() != (picture ? 3 * uint64_t(sky.width) * sky.height : 0)) return "sky: texels do not match its size";
    const float numbers[] = {sky.rotate_deg, sky.strength};
    if (!all_finite(numbers) || !all_finite(sky.color) || !all_finite(sky.horizon) || !all_finite(sky.ground))
        return "sky: not a finite number";
    if (!std::all_of(s.sky.texels.begin(), s.sky.texels.end(), [](float x) { return x >= 0 && std::isfinite(x); }))
        return "sky: a texel is negative or not finite";
    return {};
}

Problem check_view(const Scene& s) {
    for (size_t i = 0; i < s.lights.size(); ++i) {
        if (const Problem fault = light_fault(s.lights[i].values)) return text("light", i, fault.text());
    }
    for (size_t i = 0; i < s.cameras.size(); ++i) {
        const Camera& camera = s.cameras[i];
        if (!all_finite(camera.eye) || !all_finite(camera.target) || !all_finite(camera.up)) {
            return text("camera", i, "not a finite number");
        }
        if (!(camera.fov_y_rad > 0 && camera.fov_y_rad < static_cast<float>(kPi)))
            return text("camera", i, "field of view outside 0..180 degrees");
        for (const float size : {camera.aperture, camera.focus})
            if (!(size >= 0 && std::isfinite(size))) return text("camera", i, "aperture or focus is no length");
        if (camera.eye == camera.target) return text("camera", i, "it looks at its own eye");
    }
    if (!all_finite(s.background) || !all_finite(s.ambient)) return "background or ambient light is not a finite number";
    if (s.up_axis > 2) return "up axis " + std::to_string(s.up_axis) + " of 3";
    if (!std::isfinite(s.unit_scale) || s.unit_scale < 0) return "unit scale is not a positive number";
    return {};
}

}  // namespace

Problem validate(const Scene& scene) {
    for (const auto check :
         {check_arrays, check_meshes, check_analytic, check_shapes, check_looks, check_sky, check_view, validate_motion}) {
        if (Problem why = check(scene)) return why;
    }
    return {};
}

}  // namespace clarity
