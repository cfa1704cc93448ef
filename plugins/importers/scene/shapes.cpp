#include "shapes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

namespace scene_format {
namespace {

using Double3 = std::array<double, 3>;

Double3 point(const float* p, const Double3& origin) {
    return {p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]};
}
Double3 cross(const Double3& a, const Double3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Double3& a, const Double3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double box_size(const float* corners, size_t count) {
    double size = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
        float low = corners[axis], high = low;
        for (size_t i = 1; i < count; ++i) {
            low = std::min(low, corners[3 * i + axis]);
            high = std::max(high, corners[3 * i + axis]);
        }
        size = std::max(size, double{high} - double{low});
    }
    return size;
}

// Twice the vector area (Newell's method). Coordinates are relative to the first corner, so that a polygon far from the origin
// loses no precision.
Double3 newell_normal(const float* corners, size_t count) {
    const Double3 origin{corners[0], corners[1], corners[2]};
    Double3 sum{};
    for (size_t i = 0; i < count; ++i) {
        const Double3 c = cross(point(corners + 3 * i, origin), point(corners + 3 * ((i + 1) % count), origin));
        for (size_t axis = 0; axis < 3; ++axis) sum[axis] += c[axis];
    }
    return sum;
}

}  // namespace

const rt_key& key_of(const rt_primitive_kind& kind, size_t index) {
    return *reinterpret_cast<const rt_key*>(reinterpret_cast<const char*>(kind.keys) + index * kind.key_bytes);
}

std::vector<float> read_values(Statement& s, const rt_key& key) {
    const std::string what = std::string("`") + key.name + "` (" + key.help + ")";
    const auto three = [](const Vec3& v) { return std::vector<float>(v.begin(), v.end()); };
    const auto least = static_cast<float>(key.min), most = static_cast<float>(key.max);
    switch (key.kind) {
        case RT_KEY_NUMBER:
            return {s.number_between(what, least, most)};
        case RT_KEY_WHOLE: {
            const float value = s.number_between(what, least, most);
            if (value != std::floor(value)) s.fail_at_last("expected a whole number for " + what);
            return {value};
        }
        case RT_KEY_POINT:
            return three(s.vector(what));
        case RT_KEY_VECTOR: {
            const Position start = s.next();
            const Vec3 v = s.vector(what);
            if (v == Vec3{0, 0, 0})
                throw StatementError{start, "the zero vector has no direction; expected another for " + what};
            return three(v);
        }
        case RT_KEY_NUMBERS:
            return s.numbers(what, 1, least, most);
        case RT_KEY_POINTS:
            return s.numbers(what, 3, least, most);
    }
    throw StatementError{s.last(), std::string("key `") + key.name + "` is of a kind that this importer does not know"};
}

Kinds kinds_of(const rt_scene_sink& sink) {
    if (!RT_HAS(&sink, rt_scene_sink, map_kind) || !sink.light_kind || !sink.material_kind || !sink.sky_kind || !sink.map_kind)
        throw std::runtime_error(
            "this importer needs a newer Clarity, which tells it the keys of lights, materials, their textures and skies: "
            "update the program");
    Kinds kinds;
    kinds.material = sink.material_kind(sink.ctx);
    kinds.maps = sink.map_kind(sink.ctx);
    const auto all = [&](auto kind, std::vector<const rt_primitive_kind*>& list) {
        while (const rt_primitive_kind* next = kind(sink.ctx, static_cast<rt_u32>(list.size()))) list.push_back(next);
    };
    all(sink.light_kind, kinds.lights);
    all(sink.sky_kind, kinds.skies);
    if (sink.primitive_kind && sink.primitive) all(sink.primitive_kind, kinds.shapes);
    return kinds;
}

void read_shape(Statement& s, const rt_primitive_kind& kind, Document& document) {
    std::vector<Key> keys;
    Shape shape;
    shape.kind = kind.id;
    shape.values.resize(kind.key_count);
    for (size_t i = 0; i < kind.key_count; ++i) {
        const rt_key& key = key_of(kind, i);
        keys.push_back({key.name});
        const size_t count = key.kind >= RT_KEY_NUMBERS ? 0 : key.kind >= RT_KEY_POINT ? 3 : 1;
        for (size_t k = 0; k < count; ++k) shape.values[i].numbers.push_back(static_cast<float>(key.def[k]));
    }
    keys.push_back({"material"});
    s.expect_keys(keys);
    while (!s.done()) {
        const size_t i = s.key();
        if (i == kind.key_count) {
            shape.material = s.name("a material's name");
        } else {
            shape.values[i] = {read_values(s, key_of(kind, i)), true};
        }
    }
    for (size_t i = 0; i < kind.key_count; ++i) {
        const rt_key& key = key_of(kind, i);
        if ((key.flags & RT_KEY_REQUIRED) && !shape.values[i].given)
            throw StatementError{s.position(), std::string(s.word()) + " without `" + key.name + "`; expected " + key.help};
    }
    document.items.push_back({ItemKind::shape, static_cast<uint32_t>(document.shapes.size()), s.position()});
    document.shapes.push_back(std::move(shape));
}

std::string polygon_fault(const std::vector<float>& corners) {
    const size_t count = corners.size() / 3;
    const double size = box_size(corners.data(), count);
    Double3 normal = newell_normal(corners.data(), count);
    const double length = std::sqrt(dot(normal, normal));
    if (!(length > 2 * kAreaTolerance * size * size)) {
        return "the polygon has no area (its corners lie on a line or cancel out); expected a surface";
    }
    for (double& component : normal) component /= length;
    const Double3 origin{corners[0], corners[1], corners[2]};
    double mean = 0;
    for (size_t i = 0; i < count; ++i) mean += dot(normal, point(&corners[3 * i], origin)) / static_cast<double>(count);
    size_t worst_corner = 0;
    double worst = 0;
    for (size_t i = 0; i < count; ++i) {
        const double distance = std::fabs(dot(normal, point(&corners[3 * i], origin)) - mean);
        if (distance > worst) {
            worst = distance;
            worst_corner = i + 1;
        }
    }
    if (worst <= kPlanarTolerance * size) return {};
    char text[160];
    std::snprintf(text, sizeof text,
                  "corner %zu lies %.3g off the plane of the polygon; expected at most %.3g (%g of its size)", worst_corner,
                  worst, kPlanarTolerance * size, kPlanarTolerance);
    return text;
}

bool triangle_is_degenerate(const std::array<float, 9>& corners) {
    const double size = box_size(corners.data(), 3);
    const Double3 normal = newell_normal(corners.data(), 3);
    return !(std::sqrt(dot(normal, normal)) > 2 * kAreaTolerance * size * size);
}

}  // namespace scene_format
