#include "shapes.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace scene_format {

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

}  // namespace scene_format
