// The importer plugin `scene`, for the text format of docs/scene_format.md.
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "../common/mapped_file.hpp"
#include "document.hpp"
#include "emit.hpp"
#include "lexer.hpp"
#include "rt_plugin.hpp"
#include "shapes.hpp"
#include "statements.hpp"

namespace scene_format {
namespace {

constexpr uint32_t kLinesBetweenReports = 4096;

void read_statement(Statement& statement, const Token& first, Document& document, Diagnostics& diagnostics) {
    std::vector<std::string_view> words;
    if (first.is_quoted) {
        throw StatementError{first.position,
                             "text in quotes, " + in_quotes(first.text) + "; expected a statement, without quotes"};
    }
    for (const auto& [word, read] : statements()) {
        if (word == first.text) {
            read(statement, document, diagnostics);
            ++document.statement_count;
            return;
        }
        words.push_back(word);
    }
    for (const rt_primitive_kind* kind : document.kinds.shapes) {
        if (kind->id == first.text) {
            read_shape(statement, *kind, document);
            ++document.statement_count;
            return;
        }
        words.push_back(kind->id);
    }
    throw StatementError{first.position, "unknown statement " + in_quotes(first.text) + suggestion(first.text, words) +
                                             " (statements: " + listed(words) + ")"};
}

// The positions at which names are defined. Each name may be defined once.
using Names = std::map<std::string, Position, std::less<>>;

template <class Things>
Names defined_names(const Things& things, const char* kind, Diagnostics& diagnostics) {
    Names names;
    for (const auto& thing : things) {
        const Name& name = thing.name;
        if (name.text.empty() || diagnostics.full()) continue;
        const auto [first, is_new] = names.emplace(name.text, name.position);
        if (is_new) continue;
        diagnostics.error({name.position, std::string(kind) + " " + in_quotes(name.text) +
                                              " for the second time; the first is in line " +
                                              std::to_string(first->second.line)});
    }
    return names;
}

void check_use(const Name& use, const Names& names, const char* kind, Diagnostics& diagnostics) {
    if (use.text.empty() || diagnostics.full() || names.count(use.text) != 0) return;
    std::vector<std::string_view> known;
    std::string all;  // in quotes, since a name of a file may be any text
    constexpr size_t most_listed = 20;
    for (const auto& [name, position] : names) {
        if (known.size() <= most_listed)
            all += (known.empty() ? "" : ", ") + (known.size() < most_listed ? in_quotes(name) : "...");
        known.push_back(name);
    }
    if (known.empty()) all = "none";
    const std::string nearest = suggestion(use.text, known);
    diagnostics.error({use.position, "unknown " + std::string(kind) + " " + in_quotes(use.text) + nearest +
                                         " (defined in this file: " + all + ")"});
}

// A name may be used before the line that defines it, so names are resolved after all lines have been read.
void check_names(const Document& document, Diagnostics& diagnostics) {
    const Names cameras = defined_names(document.cameras, "camera", diagnostics);
    const Names materials = defined_names(document.materials, "material", diagnostics);
    const Names textures = defined_names(document.textures, "texture", diagnostics);
    const Names loads = defined_names(document.loads, "name", diagnostics);
    const auto check_materials = [&](const auto& things) {
        for (const auto& thing : things) check_use(thing.material, materials, "material", diagnostics);
    };
    check_materials(document.spheres);
    check_materials(document.planes);
    check_materials(document.polygons);
    check_materials(document.triangles);
    check_materials(document.shapes);
    check_materials(document.loads);
    for (const Material& material : document.materials)
        for (const auto& [use, name] : material.maps) check_use(name, textures, "texture", diagnostics);
    Names movable = loads;
    movable.insert(cameras.begin(), cameras.end());
    for (const Light& light : document.lights)
        if (!light.name.text.empty()) movable.emplace(light.name.text, light.name.position);
    std::set<std::pair<std::string, Animation::Motion>> moved;
    for (const Animation& animation : document.animations) {
        check_use(animation.target, movable, "name", diagnostics);
        if (diagnostics.full()) return;
        const std::string& name = animation.target.text;
        if (animation.motion == Animation::Motion::scale && movable.count(name) != 0 && loads.count(name) == 0)
            diagnostics.error({animation.target.position, in_quotes(name) + " is no loaded object; only those can be scaled"});
        if (animation.motion == Animation::Motion::fov && movable.count(name) != 0 && cameras.count(name) == 0)
            diagnostics.error({animation.target.position, in_quotes(name) + " is no camera; only cameras have a `fov`"});
        if (!moved.emplace(name, animation.motion).second)
            diagnostics.error({animation.target.position, "the same motion of " + in_quotes(name) +
                                                              " for the second time; put all its keys into one line"});
    }
}

// Reads the whole text, by the kinds that the document has, and continues after errors, up to Diagnostics::kMaxErrors. Calls
// `proceed` with the fraction that is done (0..1). If `proceed` returns false, parsing stops and the function returns false;
// the document is then incomplete. Otherwise it returns true, also if there were errors.
bool parse(std::string_view text, Document& document, Diagnostics& diagnostics, const std::function<bool(float)>& proceed) {
    Lexer lexer(text);
    std::vector<Token> tokens;
    uint32_t lines = 0;
    bool is_complete = true;
    while (is_complete && !diagnostics.full()) {
        if (lines++ % kLinesBetweenReports == 0 && !proceed(lexer.fraction())) return false;
        try {
            if (!lexer.next_line(tokens)) break;
            Statement statement(tokens, lexer.line_end());
            read_statement(statement, tokens[0], document, diagnostics);
        } catch (const StatementError& error) {
            diagnostics.error(error);
            is_complete = !error.ends_reading;
        }
    }
    if (is_complete && !diagnostics.full()) check_names(document, diagnostics);
    if (document.statement_count == 0 && !diagnostics.failed()) {
        diagnostics.error({{1, 1}, "the file holds no statement; expected at least one, like `sphere center 0 0 0 radius 1`"});
    }
    return true;
}

// Reports the first error to the user, and writes the others to the log.
int32_t report(const Diagnostics& diagnostics, const char* path, const rt_host& host) {
    const std::vector<Diagnostic> errors = diagnostics.errors();
    for (size_t i = 1; i < errors.size(); ++i) host.log(host.ctx, RT_LOG_WARNING, located(path, errors[i]).c_str());
    std::string first = located(path, errors[0]);
    if (errors.size() > 1) {
        const bool stopped = diagnostics.full();
        first += " [and " + std::to_string(errors.size() - 1) + (stopped ? " or more" : "") + " further " +
                 (errors.size() == 2 && !stopped ? "error" : "errors") + ", in the log]";
    }
    return host.fail(host.ctx, first.c_str());
}

int32_t load_text(std::string_view text, const rt_host& host, const char* path, const rt_scene_sink& sink) {
    if (text.size() > kMaxFileBytes)
        throw std::runtime_error("the file is larger than " + std::to_string(kMaxFileBytes >> 20) +
                                 " MiB; give large meshes as PLY or OBJ and `load` them");
    Document document;
    document.kinds = kinds_of(sink);
    Diagnostics diagnostics;
    const auto proceed = [&](float fraction) { return host.progress(host.ctx, 0.5f * fraction) != 0; };
    if (!parse(text, document, diagnostics, proceed)) return RT_CANCELLED;
    if (diagnostics.failed()) return report(diagnostics, path, host);
    for (const Diagnostic& warning : diagnostics.warnings()) sink.warn(sink.ctx, located(path, warning).c_str());
    return emit(document, path, host, sink);
}

int32_t load(const rt_host* host, const char* path, const double*, const rt_scene_sink* sink) {
    try {
        const importers::MappedFile file(host, path);
        return load_text(file.bytes(), *host, path, *sink);
    } catch (const std::runtime_error& error) {
        throw rt::fail(host, std::string(path) + ": " + error.what());
    }
}

constexpr const char* kExtensions[] = {"scene", nullptr};
constexpr rt_importer kImporter = {sizeof(rt_importer), kExtensions, nullptr, rt::guarded<load>, RT_IMPORTER_TAKES_CONTENT, 0};

}  // namespace

}  // namespace scene_format

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 =
    rt::importer_plugin("scene", "Text scene", "1.0.0", nullptr, scene_format::kImporter);
