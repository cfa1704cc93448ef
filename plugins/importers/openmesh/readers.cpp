#include "readers.hpp"

#include <algorithm>
#include <cmath>

namespace openmesh_import {
namespace {

constexpr double kFar = 16;  // how many times as far from 0 as it is large a mesh has to be

}  // namespace

void warn(const Source& source, const std::string& text) {
    source.sink.warn(source.sink.ctx, text.c_str());
}

std::string too_large(const char* what, unsigned long long count, unsigned long long least_bytes,
                      unsigned long long available) {
    if (count <= available / least_bytes && count < 0x7FFFFFFFull) return {};
    return "declares " + std::to_string(count) + " elements '" + what + "' of at least " + std::to_string(least_bytes) +
           " bytes and has " + std::to_string(available) + " bytes for them: it is cut off or damaged";
}

void FlatMesh::add_vertex(double x, double y, double z) {
    positions.insert(positions.end(), 3, 0.0f);
    set_vertex(vertex_count() - 1, x, y, z);
}

void FlatMesh::set_vertex(size_t vertex, double x, double y, double z) {
    if (vertex >= vertex_count()) return;
    float* const to = &positions[3 * vertex];
    to[0] = static_cast<float>(x);
    to[1] = static_cast<float>(y);
    to[2] = static_cast<float>(z);
    const bool finite = std::isfinite(to[0]) && std::isfinite(to[1]) && std::isfinite(to[2]);
    if (!finite) unusable_.resize(vertex_count(), false);
    if (vertex < unusable_.size()) unusable_[vertex] = !finite;
    if (!finite) std::fill_n(to, 3, 0.0f);
    if (keeps_digits_) keep_digits(vertex, {finite ? x : 0, finite ? y : 0, finite ? z : 0});
}

void FlatMesh::keep_digits(size_t vertex, const double (&at)[3]) {
    digits_.resize(positions.size());
    const bool is_used = vertex >= unusable_.size() || !unusable_[vertex];
    double size = 0, farthest = 0;
    for (int k = 0; k < 3; ++k) {
        digits_[3 * vertex + size_t(k)] = static_cast<float>(at[k] - double(positions[3 * vertex + size_t(k)]));
        has_digits_ = has_digits_ || digits_[3 * vertex + size_t(k)] != 0;
        if (is_used) lo_[k] = std::min(lo_[k], at[k]), hi_[k] = std::max(hi_[k], at[k]);
        size = std::max(size, hi_[k] - lo_[k]);
        farthest = std::max({farthest, std::fabs(lo_[k]), std::fabs(hi_[k])});
    }
    keeps_digits_ = !is_used || farthest >= kFar * size;
    if (!keeps_digits_) digits_ = {};
}

void FlatMesh::subtract_origin() {
    const double size = std::max({hi_[0] - lo_[0], hi_[1] - lo_[1], hi_[2] - lo_[2]});
    if (!keeps_digits_ || !has_digits_ || !(size > 0)) return;
    // A multiple of a power of two as large as the mesh: it has few digits, so that a float holds it.
    const double grid = std::ldexp(1.0, std::ilogb(size));
    for (size_t k = 0; k < 3; ++k) origin[k] = std::round((lo_[k] + hi_[k]) / 2 / grid) * grid;
    for (size_t i = 0; i < positions.size(); ++i)
        positions[i] = static_cast<float>(double(positions[i]) - origin[i % 3] + double(digits_[i]));
    digits_ = {};
}

void FlatMesh::leave_out_broken() {
    size_t kept = 0, kept_corners = 0, first = 0;
    const auto move_corners = [&](std::vector<rt_u32>& list, size_t count) {
        if (!list.empty())
            std::copy_n(list.begin() + static_cast<ptrdiff_t>(first), count, list.begin() + ptrdiff_t(kept_corners));
    };
    for (size_t face = 0; face < sizes.size(); ++face) {
        const size_t count = sizes[face];
        const auto begin = corners.begin() + static_cast<ptrdiff_t>(first), end = begin + static_cast<ptrdiff_t>(count);
        const auto broken = std::find_if(begin, end, [&](rt_u32 v) { return !is_usable(v); });
        if (broken != end) {
            if (broken_faces++ == 0) {
                first_broken_face = face;
                first_broken_vertex = *broken;
            }
        } else {
            if (kept_corners != first) {
                for (auto* list : {&corners, &normal_of_corner, &uv_of_corner}) move_corners(*list, count);
            }
            sizes[kept] = sizes[face];
            if (!face_materials.empty()) face_materials[kept] = face_materials[face];
            ++kept;
            kept_corners += count;
        }
        first += count;
    }
    sizes.resize(kept);
    for (auto* list : {&corners, &normal_of_corner, &uv_of_corner})
        if (!list->empty()) list->resize(kept_corners);
    if (!face_materials.empty()) face_materials.resize(kept);
}

void FlatMesh::copy_vertices() {
    const bool has_normals = !normal_of_corner.empty(), has_uvs = !uv_of_corner.empty();
    if (!has_normals && !has_uvs) return;
    // Values of vertices (PLY has both) stay with the copies.
    const std::vector<float> own_normals = normals, own_uvs = uvs;
    std::vector<rt_u32> copy_of;
    importers::VertexCopies copies(*this, has_normals || !normals.empty(), has_uvs || !uvs.empty(), false, false, copy_of);
    const float zero[3] = {0, 0, 0};
    const auto value = [&](const std::vector<rt_u32>& of_corner, const std::vector<float>& values, size_t corner,
                           const std::vector<float>& own, size_t width) {
        if (of_corner.empty()) return own.empty() ? zero : &own[width * corners[corner]];
        const rt_u32 number = of_corner[corner];
        return number == RT_NONE || width * (size_t(number) + 1) > values.size() ? zero : &values[width * number];
    };
    for (size_t i = 0; i < corners.size(); ++i) {
        const float* const normal = value(normal_of_corner, corner_normals, i, own_normals, 3);
        const float* const uv = value(uv_of_corner, corner_uvs, i, own_uvs, 2);
        corners[i] = copies.vertex(corners[i], {normal, uv});
    }
}

void FlatMesh::finish() {
    subtract_origin();
    leave_out_broken();
    // A normal or uv that is not finite becomes 0 as a whole.
    const auto clean = [](std::vector<float>& values, size_t width) {
        for (size_t i = 0; i + width <= values.size(); i += width) {
            const auto at = values.begin() + static_cast<ptrdiff_t>(i);
            if (!std::all_of(at, at + static_cast<ptrdiff_t>(width), [](float x) { return std::isfinite(x); }))
                std::fill_n(at, width, 0.0f);
        }
    };
    clean(normals, 3);
    clean(corner_normals, 3);
    clean(uvs, 2);
    clean(corner_uvs, 2);
    copy_vertices();
}

}  // namespace openmesh_import
