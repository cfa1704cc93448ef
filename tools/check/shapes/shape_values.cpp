#include "tools/check/shapes/shape_values.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.hpp"
#include "import/sink/shape_parts.hpp"
#include "scene/scene.hpp"
#include "stand/seed.hpp"

namespace clarity::check {
namespace {

constexpr unsigned kSeed = 17;
constexpr size_t kMostDraws = 400;                                            // until enough values are accepted
constexpr size_t kListLengths[] = {16, 4, 9, 20, 8, 12, 6, 3, 2, 25, 1, 36};  // a plugin may take certain ones only

bool is_list(const rt_key& key) {
    return key.kind == RT_KEY_NUMBERS || key.kind == RT_KEY_POINTS;
}
bool is_triple(const rt_key& key) {
    return key.kind == RT_KEY_POINT || key.kind == RT_KEY_VECTOR;
}

std::string text_of(float x) {
    char text[32];
    std::snprintf(text, sizeof text, " %.9g", double(x));
    return text;
}

// Draws values of one shape.
class Draw {
 public:
    Draw(const rt_primitive& primitive, std::mt19937& random) : primitive_(primitive), random_(random) {
        for (rt_u32 i = 0; i < primitive.key_count; ++i)
            needs_list_ = needs_list_ || (is_list(primitive.keys[i]) && (primitive.keys[i].flags & RT_KEY_REQUIRED));
    }
    ShapeValues values() {
        ShapeValues values;
        point_.clear();
        for (rt_u32 i = 0; i < primitive_.key_count; ++i) {
            const rt_key& key = primitive_.keys[i];
            ShapeValues::Key drawn;
            drawn.given = (key.flags & RT_KEY_REQUIRED) || (!is_list(key) && share() < 0.6f);
            // How long a list must be, other keys may say: they stay at their defaults.
            if (key.kind == RT_KEY_WHOLE && needs_list_ && !(key.flags & RT_KEY_REQUIRED)) drawn.given = false;
            if (!drawn.given) {
                if (!is_list(key))
                    for (int k = 0; k < (is_triple(key) ? 3 : 1); ++k) drawn.numbers.push_back(static_cast<float>(key.def[k]));
            } else if (is_list(key)) {
                drawn.numbers = list(key, values);
            } else {
                drawn.numbers = numbers(key);
            }
            values.keys.push_back(std::move(drawn));
        }
        return values;
    }

 private:
    float share() { return std::uniform_real_distribution<float>(0, 1)(random_); }
    float within(const rt_key& key, double x) const {
        // The nearest float may be beyond the range.
        float f = static_cast<float>(std::clamp(x, key.min, key.max));
        if (f > key.max) f = std::nextafterf(f, -INFINITY);
        if (f < key.min) f = std::nextafterf(f, INFINITY);
        return f;
    }
    float around(const rt_key& key, double middle, double room) {
        return within(key, middle + room * (2 * double(share()) - 1));
    }
    std::vector<float> numbers(const rt_key& key) {
        const double usual = key.flags & RT_KEY_REQUIRED || key.def[0] == 0 ? 0.7 : std::fabs(key.def[0]);
        switch (key.kind) {
            case RT_KEY_WHOLE: {
                const double most = std::min(key.max, key.min + 8);
                return {within(key, std::floor(key.min + (most - key.min + 1) * double(share()) * 0.999))};
            }
            case RT_KEY_POINT: {
                std::vector<float> point;
                for (const double middle : key.def) point.push_back(around(key, middle, 1));
                if (!point_.empty() && share() < 0.25f) {  // from the point before along an axis
                    const auto axis = static_cast<size_t>(share() * 2.99f);
                    for (size_t k = 0; k < 3; ++k)
                        if (k != axis) point[k] = within(key, double(point_[k]));
                }
                return point_ = point;
            }
            case RT_KEY_VECTOR:
                if (share() < 0.25f) {  // along an axis
                    std::vector<float> along(3, within(key, 0));
                    along[static_cast<size_t>(share() * 2.99f)] = within(key, share() < 0.5f ? 1 : -1);
                    return along;
                }
                return {around(key, 0, 1), around(key, 0, 1), around(key, 0, 1)};
            default: {
                double x = usual * std::exp(2 * double(share()) - 1);
                if (key.min < 0 && share() < 0.5f) x = -x;
                return {within(key, x)};
            }
        }
    }
    // Points of a list lie on a bent sheet, row after row, so that a surface through them is a usual one.
    std::vector<float> list(const rt_key& key, const ShapeValues& before) {
        const size_t length = kListLengths[static_cast<size_t>(share() * float(std::size(kListLengths)) * 0.999f)];
        std::vector<float> all;
        if (key.kind == RT_KEY_NUMBERS) {
            for (size_t i = 0; i < length; ++i) all.push_back(within(key, 0.5 + double(share())));
            return all;
        }
        size_t columns = std::max<size_t>(1, static_cast<size_t>(std::lround(std::sqrt(double(length)))));
        size_t greatest = 0;  // whole number that may be the columns
        for (rt_u32 i = 0; i < before.keys.size(); ++i)
            if (primitive_.keys[i].kind == RT_KEY_WHOLE) {
                const auto n = static_cast<size_t>(std::clamp(before.keys[i].numbers[0], 0.f, 1e6f));
                if (n > greatest && length % n == 0) greatest = n;
            }
        if (greatest > 1) columns = greatest;
        for (size_t i = 0; i < length; ++i) {
            const size_t column = i % columns, row = i / columns;
            all.push_back(within(key, double(column) + 0.2 * double(share())));
            all.push_back(within(key, double(row) + 0.2 * double(share())));
            all.push_back(around(key, 0, 0.6));
        }
        return all;
    }

    const rt_primitive& primitive_;
    std::mt19937& random_;
    bool needs_list_ = false;
    std::vector<float> point_;  // the last one of these values
};

}  // namespace

std::string ShapeValues::statement(const rt_plugin& plugin) const {
    std::string text = plugin.id;
    for (size_t i = 0; i < keys.size(); ++i) {
        if (!keys[i].given) continue;
        text += std::string(" ") + plugin.primitive->keys[i].name;
        for (const float x : keys[i].numbers) text += text_of(x);
    }
    return text;
}

ShapeValues random_values(const rt_primitive& primitive, std::mt19937& random) {
    return Draw(primitive, random).values();
}

std::vector<ShapeValues> values_at_ends(const rt_primitive& primitive, const ShapeValues& usual) {
    std::vector<ShapeValues> all;
    for (rt_u32 i = 0; i < primitive.key_count; ++i) {
        const rt_key& key = primitive.keys[i];
        for (const bool most : {false, true}) {
            ShapeValues values = usual;
            ShapeValues::Key& at = values.keys[i];
            float end = static_cast<float>(most ? key.max : key.min);
            if (end > key.max) end = std::nextafterf(end, -INFINITY);
            if (end < key.min) end = std::nextafterf(end, INFINITY);
            if (is_list(key) && at.numbers.empty()) continue;
            if (key.kind == RT_KEY_VECTOR && end == 0) continue;
            if (is_triple(key) || is_list(key))
                at.numbers[0] = end;
            else
                at.numbers = {end};
            at.given = true;
            values.what = std::string("`") + key.name + "` at its " + (most ? "greatest" : "least") + " value," + text_of(end);
            all.push_back(std::move(values));
        }
    }
    return all;
}

ShapeTrial try_values(const rt_plugin& plugin, const ShapeValues& values) {
    ShapeTrial trial;
    trial.values = values;
    std::vector<rt_key_values> table;
    for (const ShapeValues::Key& key : values.keys)
        table.push_back({key.numbers.data(), static_cast<rt_u32>(key.numbers.size()), key.given ? 1u : 0u});
    rt_primitive_desc desc{};
    desc.struct_bytes = sizeof desc;
    desc.kind = plugin.id;
    desc.values = table.data();
    desc.value_count = static_cast<rt_u32>(table.size());
    trial.scene.materials.push_back({"default", default_material()});
    trial.scene.shape_kinds.push_back({plugin.id, &plugin});
    Shape shape;
    Progress progress;
    try {
        import::add_shape_parts(*plugin.primitive, desc, plugin.id, progress, trial.scene, shape);
        trial.scene.shapes.push_back(shape);
    } catch (const Error& e) {
        trial.why = e.what(), trial.failure = e.failure();
    }
    return trial;
}

std::vector<ShapeTrial> accepted_trials(const rt_plugin& plugin, size_t count, uint64_t seed,
                                        std::vector<ShapeTrial>* refused) {
    std::mt19937 random = random_of(kSeed, seed);
    std::vector<ShapeTrial> accepted;
    for (size_t draw = 0; draw < kMostDraws && accepted.size() < count; ++draw) {
        ShapeTrial trial = try_values(plugin, random_values(*plugin.primitive, random));
        if (trial.why.empty())
            accepted.push_back(std::move(trial));
        else if (refused)
            refused->push_back(std::move(trial));
    }
    return accepted;
}

}  // namespace clarity::check
