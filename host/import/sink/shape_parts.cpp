#include "import/sink/shape_parts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.hpp"
#include "base/problem.hpp"
#include "plugin/host_services.hpp"
#include "scene/usable.hpp"

namespace clarity::import {
namespace {

constexpr size_t kMostParts = RT_REF_INDEX_MAX, kMostNumbers = 1u << 30;
constexpr size_t kAlignment = 4;  // numbers: kernels may read four at once

std::string number_text(double number) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", number);
    return text;
}

// Returns what is wrong with the values of a key; empty: nothing.
Problem key_fault(const rt_key& key, const rt_key_values& values) {
    const std::string who = std::string("`") + key.name + "`";
    const bool triples = key.kind == RT_KEY_POINT || key.kind == RT_KEY_VECTOR || key.kind == RT_KEY_POINTS;
    const bool list = key.kind == RT_KEY_NUMBERS || key.kind == RT_KEY_POINTS;
    const rt_u32 expected = triples ? 3 : 1;
    if (!values.given && (key.flags & RT_KEY_REQUIRED)) return who + " is missing (" + key.help + ")";
    if (list ? values.count % expected != 0 : values.count != expected)
        return who + " has " + std::to_string(values.count) + " numbers, expected " + (list ? "a multiple of " : "") +
               std::to_string(expected);
    if (values.count > 0 && !values.numbers) return who + " has no numbers";
    for (rt_u32 i = 0; i < values.count; ++i) {
        const float x = values.numbers[i];
        if (!is_usable(x)) return who + ": a number is not finite, or beyond 1e15";
        if (x < static_cast<float>(key.min) || x > static_cast<float>(key.max))  // 1e-12, as a float, is less than 1e-12
            return who + ": " + number_text(x) + " is out of range, expected " + number_text(key.min) + " to " +
                   number_text(key.max) + " (" + key.help + ")";
        if (key.kind == RT_KEY_WHOLE && x != std::floor(x)) return who + ": " + number_text(x) + " is no whole number";
    }
    if (key.kind == RT_KEY_VECTOR && values.numbers[0] == 0 && values.numbers[1] == 0 && values.numbers[2] == 0)
        return who + ": the zero vector has no direction";
    return {};
}

// Receives the parts of one shape.
class Parts {
 public:
    Parts(HostServices& services, Scene& scene) : services_(services), scene_(scene) {
        out_.struct_bytes = sizeof out_;
        out_.ctx = this;
        out_.part = [](void* ctx, const float lo[3], const float hi[3], const float* numbers, rt_u32 count, const float* more,
                       uint64_t more_count) {
            auto* self = static_cast<Parts*>(ctx);
            try {
                return self->add(lo, hi, numbers, count, more, more_count);
            } catch (const std::exception& e) {  // the plugin may be written in C
                self->services_.fail(e.what());
                return int32_t(RT_FAILED);
            }
        };
    }
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;
    const rt_shape_output* table() const { return &out_; }

    int32_t add(const float* lo, const float* hi, const float* numbers, rt_u32 count, const float* more, uint64_t more_count) {
        ShapePart part;
        if (!lo || !hi || (count > 0 && !numbers) || (more_count > 0 && !more)) return fail("handed over NULL for a part");
        if (count > RT_SHAPE_NUMBERS)
            return fail("gave " + std::to_string(count) + " numbers for a part, at most " + std::to_string(RT_SHAPE_NUMBERS) +
                        " are taken: hand over the others as `more`");
        if (scene_.shape_parts.size() >= kMostParts || more_count > kMostNumbers ||
            scene_.shape_numbers.size() + more_count > kMostNumbers)
            return fail("made more parts or numbers than a scene can hold");
        for (int k = 0; k < 3; ++k)
            if (!is_usable(lo[k]) || !is_usable(hi[k]) || lo[k] > hi[k])
                return fail("gave a box that is not finite, too large or inside out");
        if (!are_usable(numbers, count) || !are_usable(more, more_count))
            return fail("gave a number that is not finite or too large");
        std::copy_n(lo, 3, part.min.begin());
        std::copy_n(hi, 3, part.max.begin());
        std::copy_n(numbers, count, part.numbers.begin());
        std::vector<float>& all = scene_.shape_numbers;
        all.resize((all.size() + kAlignment - 1) / kAlignment * kAlignment);
        part.first_more = static_cast<rt_u32>(all.size());
        part.more_count = static_cast<rt_u32>(more_count);
        all.insert(all.end(), more, more + more_count);
        scene_.shape_parts.push_back(part);
        return RT_OK;
    }

 private:
    int32_t fail(const std::string& why) {
        services_.fail("its plugin " + why, Failure::plugin_fault);
        return RT_FAILED;
    }

    HostServices& services_;
    Scene& scene_;
    rt_shape_output out_{};
};

// A shape whose kernels take the values as they are.
int32_t single_part(const rt_primitive& primitive, const rt_host* host, const rt_primitive_desc& desc, Parts& parts) {
    float lo[3] = {}, hi[3] = {};
    const int32_t status = primitive.bounds(host, desc.values, lo, hi);
    if (status != RT_OK) return status;
    std::vector<float> numbers;
    for (rt_u32 i = 0; i < primitive.key_count; ++i)
        numbers.insert(numbers.end(), desc.values[i].numbers, desc.values[i].numbers + desc.values[i].count);
    return parts.add(lo, hi, numbers.data(), static_cast<rt_u32>(numbers.size()), nullptr, 0);
}

}  // namespace

void add_shape_parts(const rt_primitive& primitive, const rt_primitive_desc& desc, const std::string& speaker,
                     Progress& progress, Scene& scene, Shape& shape) {
    const auto fail = [&](const std::string& why, Failure failure = Failure::other) {
        throw Error(Exit::import_failed, speaker + ": " + why).as(failure);
    };
    if (desc.value_count != primitive.key_count || !desc.values)
        fail(std::to_string(desc.value_count) + " values, but the shape has " + std::to_string(primitive.key_count) + " keys");
    for (rt_u32 i = 0; i < primitive.key_count; ++i)
        if (const Problem why = key_fault(primitive.keys[i], desc.values[i])) fail(why.text());
    HostServices services(speaker, progress);
    Parts parts(services, scene);
    shape.first_part = static_cast<rt_u32>(scene.shape_parts.size());
    services.check(static_cast<int>(Exit::import_failed), [&] {
        return primitive.prepare ? primitive.prepare(services.host(), desc.values, parts.table())
                                 : single_part(primitive, services.host(), desc, parts);
    });
    shape.part_count = static_cast<rt_u32>(scene.shape_parts.size()) - shape.first_part;
    if (shape.part_count == 0) fail("its plugin made no part of it; this is a fault of the plugin", Failure::plugin_fault);
}

}  // namespace clarity::import
