#include "tools/check/shapes/key_checks.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "import/sink/scene_builder.hpp"
#include "stand/seed.hpp"
#include "tools/check/process_size.hpp"
#include "tools/check/shapes/shape_values.hpp"

namespace clarity::check {
namespace {

using Inputs = std::shared_ptr<const KeyInputs>;

constexpr double kLimit_s = 7;  // processor time for one shape

Outcome values(const KeyInputs& inputs, const Step& step, size_t count) {
    step("trying usual values of its keys", kLimit_s);
    std::vector<ShapeTrial> refused;
    const std::vector<ShapeTrial> accepted = accepted_trials(*inputs.plugin, count, inputs.seed, &refused);
    for (const ShapeTrial& trial : refused) {
        const std::string statement = "`" + trial.values.statement(*inputs.plugin) + "`: ";
        // Not refused for its values, but for what the plugin did with them.
        if (trial.failure == Failure::plugin_fault) return Outcome::failed(statement + trial.why);
        if (trial.failure == Failure::no_reason)
            return Outcome::failed(statement + "is refused without a reason: say what is wrong with host->fail (rt::fail)");
    }
    if (accepted.empty())
        return Outcome::failed("no values of about 1 are accepted; `" + refused.front().values.statement(*inputs.plugin) +
                               "`: " + refused.front().why);
    size_t parts = 0;
    for (const ShapeTrial& trial : accepted) parts += trial.scene.shape_parts.size();
    return Outcome::passed(std::to_string(accepted.size()) + " shapes of " + std::to_string(parts) + " parts, " +
                           std::to_string(refused.size()) + " refused with a reason");
}

Outcome ends(const KeyInputs& inputs, const Step& step, size_t count) {
    size_t accepted = 0, refused = 0;
    for (const ShapeTrial& usual : accepted_trials(*inputs.plugin, count, inputs.seed))
        for (const ShapeValues& values : values_at_ends(*inputs.plugin->primitive, usual.values)) {
            step("trying " + values.what, kLimit_s);
            const ShapeTrial trial = try_values(*inputs.plugin, values);
            if (trial.failure == Failure::plugin_fault || trial.failure == Failure::no_reason)
                return Outcome::failed(values.what + ", in `" + values.statement(*inputs.plugin) + "`: " + trial.why +
                                       "; narrow the key's range, or refuse such values with a reason");
            ++(trial.why.empty() ? accepted : refused);
        }
    return Outcome::passed(std::to_string(accepted) + " values at the ends accepted, " + std::to_string(refused) +
                           " refused with a reason");
}

// Whether two shapes have the same parts.
bool same(const Scene& a, const Scene& b) {
    if (a.shape_parts.size() != b.shape_parts.size() || a.shape_numbers != b.shape_numbers) return false;
    for (size_t i = 0; i < a.shape_parts.size(); ++i) {
        const ShapePart &x = a.shape_parts[i], &y = b.shape_parts[i];
        if (x.min != y.min || x.max != y.max || x.numbers != y.numbers || x.more_count != y.more_count) return false;
    }
    return true;
}

Outcome state(const KeyInputs& inputs, const Step& step) {
    step("trying the same values again", kLimit_s);
    const std::vector<ShapeTrial> first = accepted_trials(*inputs.plugin, 6, inputs.seed);
    if (first.empty()) return Outcome::skipped("it accepts no values (see keys.values)");
    for (size_t i = first.size(); i-- > 0;) {
        const ShapeTrial again = try_values(*inputs.plugin, first[i].values);
        if (again.why != first[i].why || !same(again.scene, first[i].scene))
            return Outcome::failed("`" + first[i].values.statement(*inputs.plugin) +
                                   "` becomes another shape when it is there twice: the plugin keeps state");
    }
    return Outcome::passed(std::to_string(first.size()) + " shapes are the same again");
}

Outcome leaks(const KeyInputs& inputs, const Step& step, bool quick) {
    const std::vector<ShapeTrial> first = accepted_trials(*inputs.plugin, 1, inputs.seed);
    if (first.empty()) return Outcome::skipped("it accepts no values (see keys.values)");
    return find_leaks("shape", quick ? 40 : 100, [&](unsigned) {
        step("making a shape again and again", kLimit_s);
        try_values(*inputs.plugin, first.front().values);
    });
}

Outcome statements(const KeyInputs& inputs, const Step& step) {
    size_t wrong = 0, sound = 0;
    for (const KeyInputs::Statement& statement : inputs.statements) {
        const std::string file = std::filesystem::path(statement.path).filename().string();
        step("reading " + (statement.what.empty() ? "a usual statement" : statement.what), kLimit_s);
        std::string why;
        bool is_read = true;  // by an importer
        Scene scene;
        try {
            Progress progress;
            const import::FileAccess access({statement.path}, {});
            import::SceneBuilder builder(inputs.plugins, {}, access, progress);
            builder.add_root(statement.path);
            scene = builder.take();
        } catch (const Error& e) {
            why = e.what(), is_read = e.failure() != Failure::no_importer;
        }
        if (statement.what.empty()) {
            if (!is_read) return Outcome::skipped("no importer of text scenes is there: " + why);
            const ShapeTrial trial = try_values(*inputs.plugin, statement.values);
            if (trial.why.empty() && (!why.empty() || scene.shapes.size() != 1 || !same(trial.scene, scene)))
                return Outcome::failed("`" + statement.values.statement(*inputs.plugin) + "` becomes " +
                                       (why.empty() ? "another shape than its values alone" : "no shape: " + why));
            ++sound;
            if (trial.why.empty()) continue;
        }
        ++wrong;
        const std::string what =
            statement.what.empty() ? "`" + statement.values.statement(*inputs.plugin) + "`" : statement.what;
        if (why.empty()) return Outcome::failed(what + " is accepted (" + statement.path + ")");
        // "file:line:column: what is wrong"
        if (why.find(file + ":1:") == std::string::npos) return Outcome::failed(what + " is refused without its place: " + why);
    }
    return Outcome::passed(std::to_string(sound) + " usual statements say what their values say, " + std::to_string(wrong) +
                           " are refused with their place");
}

// Writes one kind of statement after the other.
class Writer {
 public:
    Writer(const rt_plugin& plugin, const std::string& folder, uint64_t seed) : plugin_(plugin), folder_(folder), seed_(seed) {}

    std::vector<KeyInputs::Statement> all() {
        std::mt19937 random = random_of(1, seed_);
        for (int i = 0; i < 24; ++i) {
            usual_ = random_values(*plugin_.primitive, random);
            write(usual_.statement(plugin_), "");
            statements_.back().values = usual_;
        }
        write(usual_.statement(plugin_) + " no_such_key 1", "an unknown key");
        const rt_primitive& primitive = *plugin_.primitive;
        for (rt_u32 i = 0; i < primitive.key_count; ++i) {
            const rt_key& key = primitive.keys[i];
            const std::string name = std::string("`") + key.name + "`";
            write(with(i, " what"), "a word as " + name);
            write(with(i, " nan nan nan"), "nan as " + name);
            if (key.flags & RT_KEY_REQUIRED) write(with(i, {}), "a statement without " + name);
            if (key.kind == RT_KEY_WHOLE) write(with(i, " " + std::to_string(key.min + 0.5)), "half a number as " + name);
            if (key.kind == RT_KEY_POINT || key.kind == RT_KEY_VECTOR || key.kind == RT_KEY_POINTS)
                write(with(i, " 0.25 0.5"), "two of three numbers as " + name);
            if (key.kind == RT_KEY_VECTOR) write(with(i, " 0 0 0"), "no direction as " + name);
            if (key.kind == RT_KEY_NUMBER || key.kind == RT_KEY_WHOLE) {
                char below[40], above[40];
                std::snprintf(below, sizeof below, " %.9g", std::floor(key.min - std::max(1.0, std::fabs(key.min))));
                std::snprintf(above, sizeof above, " %.9g", std::ceil(key.max + std::max(1.0, std::fabs(key.max))));
                write(with(i, below), "a number below the least of " + name);
                write(with(i, above), "a number above the greatest of " + name);
            }
        }
        return std::move(statements_);
    }

 private:
    // The usual statement with another value of one key. An empty value leaves the key out.
    std::string with(rt_u32 key, const std::string& value) const {
        ShapeValues others = usual_;
        others.keys[key].given = false;
        std::string text = others.statement(plugin_);
        if (!value.empty()) text += std::string(" ") + plugin_.primitive->keys[key].name + value;
        return text;
    }
    void write(const std::string& text, const std::string& what) {
        const std::string path = folder_ + "/statement_" + std::to_string(statements_.size()) + ".scene";
        write_text_file(path, text + "\n");
        statements_.push_back({std::filesystem::canonical(path).string(), what, ShapeValues{}});
    }
    const rt_plugin& plugin_;
    const std::string folder_;
    const uint64_t seed_;
    ShapeValues usual_;
    std::vector<KeyInputs::Statement> statements_;
};

}  // namespace

std::vector<KeyInputs::Statement> write_statements(const rt_plugin& plugin, const std::string& folder, uint64_t seed) {
    return Writer(plugin, folder, seed).all();
}

std::vector<Check> key_checks(const Inputs& inputs, bool quick) {
    const size_t count = quick ? 12 : 60;
    return {
        {"keys.values", "usual values of its keys become boxes and numbers, or are refused with a reason",
         [=](const Step& step) { return values(*inputs, step, count); }},
        {"keys.ends", "each key at its least and greatest value",
         [=](const Step& step) { return ends(*inputs, step, quick ? 2 : 8); }},
        {"keys.state", "no state is kept from shape to shape", [=](const Step& step) { return state(*inputs, step); }},
        {"keys.leaks", "no memory, file or thread is left behind by shape after shape",
         [=](const Step& step) { return leaks(*inputs, step, quick); }},
        {"keys.text", "wrong statements of text scenes are refused, with their place",
         [=](const Step& step) { return statements(*inputs, step); }},
    };
}

}  // namespace clarity::check
