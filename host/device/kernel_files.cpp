#include "device/kernel_files.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>

#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "base/files/read_file.hpp"
#include "base/log.hpp"
#include "device/kernel_includes.hpp"
#include "rt_surface.h"

namespace clarity {
namespace {

namespace fs = std::filesystem;

struct Embedded {
    const char *name, *text;
};
const Embedded kEmbedded[] = {
#include "kernels.inc"
};

// Returns false if there is no such file. Throws Error(kernel_build_failed) if the file cannot be read.
bool read_if_present(const fs::path& path, std::string& text) {
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) return false;
    text = read_file(path.string(), kMaxTextFileBytes, Exit::kernel_build_failed);
    return true;
}

// Returns <checkout>/cl if the program is in a build folder of a checkout; else an empty path. A build folder has a
// CMakeCache.txt, the folder of an installed program does not.
fs::path checkout_kernels() {
    std::error_code error;
    const fs::path build = program_file().parent_path().parent_path();
    if (build.empty() || !fs::exists(build / "CMakeCache.txt", error)) return {};
    fs::path folder = build;
    for (int up = 0; up < 2; ++up) {
        folder = folder.parent_path();
        if (fs::exists(folder / "cl" / "CONTRACT.md", error)) return folder / "cl";
    }
    return {};
}

// A plugin's folder below that of the sources.
std::string folder_of(const rt_plugin& plugin) {
    return std::string(plugin.primitive ? "plugins/primitives/"
                       : plugin.accel   ? "plugins/accel/"
                                        : "plugins/surfaces/") +
           plugin.id;
}

// Where kernel files may be on disk.
struct Places {
    fs::path kernels;  // a folder with the layout of cl/; empty: use the embedded text
    bool beside_libraries = true;
    fs::path plugin(const rt_plugin& plugin) const { return kernels.parent_path() / folder_of(plugin); }
};

Places places() {
    static const fs::path checkout = checkout_kernels();
    const char* named = std::getenv("CLARITY_KERNEL_PATH");
    if (!named || !*named) return {checkout, true};
    if (std::string(named) == "embedded") return {{}, false};
    // "cl" and "cl/" must have the same parent.
    fs::path folder = fs::absolute(named).lexically_normal();
    if (!folder.has_filename()) folder = folder.parent_path();
    return {folder, false};
}

// The file of a plugin's library, as its user knows it; `plugin` may be the host's copy, whose texts are still the library's.
fs::path original_library(const rt_plugin& plugin) {
    return original_of(loaded_file_of(plugin.id));
}

// The folder of the sources that a library was built from. clarity_add_plugin() notes it beside the library, in ID.sources.
// Empty if there is no note, as for installed plugins.
fs::path source_folder(const rt_plugin& plugin) {
    fs::path note = original_library(plugin);
    if (note.empty()) return {};
    std::string folder;
    try {
        if (!read_if_present(note.replace_extension(".sources"), folder)) return {};
    } catch (const Error&) {
        return {};
    }
    return folder.substr(0, folder.find('\n'));
}

// A place where a plugin's file may be.
struct PluginPlace {
    enum Kind { named, sources, checkout, beside } kind;
    fs::path path;
};

// Returns where a plugin's file may be, in order of precedence.
std::vector<PluginPlace> plugin_places(const rt_plugin& plugin, const char* name) {
    std::vector<PluginPlace> all;
    const Places where = places();
    if (!where.beside_libraries) {  // CLARITY_KERNEL_PATH
        if (!where.kernels.empty()) all.push_back({PluginPlace::named, where.plugin(plugin) / name});
        return all;
    }
    if (const fs::path folder = source_folder(plugin); !folder.empty()) all.push_back({PluginPlace::sources, folder / name});
    if (!where.kernels.empty()) all.push_back({PluginPlace::checkout, where.plugin(plugin) / name});
    if (const fs::path library = original_library(plugin); !library.empty())
        all.push_back({PluginPlace::beside, library.parent_path() / name});
    return all;
}

// True for a file that was saved after the plugin's library was built.
bool is_newer_than_library(const fs::path& path, const rt_plugin& plugin) {
    std::error_code error;
    const auto built = fs::last_write_time(original_library(plugin), error);
    if (error) return true;
    const auto saved = fs::last_write_time(path, error);
    return !error && saved >= built;
}

// Logs a message once for each text of a file.
void say_once(LogLevel level, const fs::path& path, const std::string& text, const std::string& message) {
    static std::mutex mutex;
    static auto& said = *new std::map<std::string, size_t>;
    const size_t hash = std::hash<std::string>()(text + message);
    const std::lock_guard<std::mutex> lock(mutex);
    const auto [entry, first] = said.insert({path.string(), hash});
    if (!first && entry->second == hash) return;
    entry->second = hash;
    log(level, message);
}

// The last text of each file, by the name that the compiler sees.
struct Texts {
    struct Last {
        std::string path;  // "": embedded
        size_t hash;
        std::string library;  // which it is embedded in; "": this program
        bool edited = false;
        unsigned edited_line = 0;
    };
    std::mutex mutex;
    std::map<std::string, Last> last;
    uint64_t revision = 0;
};
Texts& texts() {
    static Texts* const all = new Texts;  // never freed: threads that outlive main() may still compile
    return *all;
}

// Counts from 1.
unsigned first_line_that_differs(const std::string& text, const std::string& other) {
    const auto differ = std::mismatch(text.begin(), text.end(), other.begin(), other.end()).first;
    return static_cast<unsigned>(1 + std::count(text.begin(), differ, '\n'));
}

// Records a text. The revision grows if it differs from the last one of that name. built_in: what it should be if nobody has
// edited it; nullptr: not known.
std::string remember(const std::string& shown_name, const fs::path& path, std::string text, const fs::path& library = {},
                     const char* built_in = nullptr) {
    Texts& all = texts();
    const std::lock_guard<std::mutex> lock(all.mutex);
    Texts::Last now{path.string(), std::hash<std::string>()(text), library.string()};
    if (built_in && text != built_in) {
        now.edited = true;
        now.edited_line = *built_in ? first_line_that_differs(text, built_in) : 0;
    }
    const auto [entry, first] = all.last.insert({shown_name, now});
    if (!first && entry->second.hash != now.hash) ++all.revision;
    entry->second = now;
    return text;
}

void require_same(const fs::path& path, const std::string& text, const std::string& compiled, const std::string& rebuild) {
    if (text == compiled) return;
    const unsigned line = first_line_that_differs(text, compiled);
    const std::string why = "differs from what " + rebuild;
    throw Error(Exit::kernel_build_failed, path.string() + ":" + std::to_string(line) + ": " + why, {},
                {path.string(), line, 0, why});
}

// A plugin's file as it stands at `path`, with the parts that lie beside it.
std::string with_parts(const std::string& text, const std::string& shown, const fs::path& path) {
    return expand_includes(text, shown, IncludeKind::part, [&](const std::string& name) {
        const fs::path part = path.parent_path() / name;
        std::string inner;
        if (!read_if_present(part, inner))
            throw Error(Exit::kernel_build_failed, path.string() + ": cannot read its part " + part.string() +
                                                       ": put the file there, or set CLARITY_KERNEL_PATH=embedded to run the "
                                                       "kernels inside the program");
        return remember(shown.substr(0, shown.rfind('/') + 1) + name, part, std::move(inner));
    });
}

// Adds the parts of a file on disk, and the parts of these; `all` has the file already.
void add_parts(const fs::path& path, std::vector<std::string>& all) {
    std::string text;
    if (!read_if_present(path, text)) return;
    for (const std::string& name : included_parts(text)) {
        const fs::path part = path.parent_path() / name;
        if (std::find(all.begin(), all.end(), part.string()) != all.end()) continue;
        all.push_back(part.string());
        add_parts(part, all);
    }
}

std::vector<const rt_cl_file*> kernels_of(const rt_plugin& plugin) {
    if (plugin.primitive) return {&plugin.primitive->kernels};
    if (const rt_surface* surface = rt_surface_of(&plugin)) return {&surface->kernels};
    if (plugin.accel) return {&plugin.accel->types, &plugin.accel->traverse};
    return {};
}

const char* embedded_text(const std::string& name) {
    for (const Embedded& file : kEmbedded)
        if (name == file.name) return file.text;
    return nullptr;
}

}  // namespace

std::string kernel_text(const std::string& name) {
    const Places where = places();
    if (std::error_code error; !where.kernels.empty() && !fs::is_directory(where.kernels, error))
        throw Error(Exit::kernel_build_failed,
                    "CLARITY_KERNEL_PATH: " + where.kernels.string() +
                        " is not a folder: name one with the layout of cl/ in the sources, or `embedded` for the "
                        "kernels inside the program");
    const char* embedded = embedded_text(name);
    std::string text;
    if (!where.kernels.empty() && read_if_present(where.kernels / name, text)) {
        if ((name == "rt_types.h" || name == "rt_shared.h" || name == "rt_shape.h") && embedded)
            require_same(where.kernels / name, text, embedded,
                         "this program was compiled with, so its structs may: build the program again, or set "
                         "CLARITY_KERNEL_PATH=embedded to run the kernels inside it");
        return remember("cl/" + name, where.kernels / name, std::move(text), {}, embedded ? embedded : "");
    }
    if (embedded) return remember("cl/" + name, {}, embedded);
    throw Error(Exit::kernel_build_failed, "no kernel source `" + name + "` in this program" +
                                               (where.kernels.empty() ? std::string() : " or in " + where.kernels.string()) +
                                               ": build the program again");
}

std::vector<std::string> kernel_names() {
    std::vector<std::string> names;
    for (const Embedded& file : kEmbedded) names.emplace_back(file.name);
    std::sort(names.begin(), names.end());
    return names;
}

std::string plugin_kernel_name(const rt_plugin& plugin, const rt_cl_file& file) {
    return file.name ? folder_of(plugin) + "/" + file.name : "";
}

std::string plugin_kernel_text(const rt_plugin& plugin, const rt_cl_file& file) {
    const std::string shown = plugin_kernel_name(plugin, file);
    const auto with_kernels = [&](const std::string& text) {
        return expand_includes(text, shown, IncludeKind::kernel,
                               [](const std::string& name) { return kernel_text(name.substr(std::string("cl/").size())); });
    };
    const bool is_types = plugin.accel && &file == &plugin.accel->types;
    std::string used;  // the path of the file in force
    std::string result;
    for (const PluginPlace& place : file.name ? plugin_places(plugin, file.name) : std::vector<PluginPlace>()) {
        const std::string path = place.path.string();
        std::string text;
        if (path == used || !read_if_present(path, text)) continue;
        const bool beside = place.kind == PluginPlace::beside;
        if (!used.empty() && !beside) continue;
        const std::string whole = with_parts(text, shown, path);
        const bool as_built = file.text && whole == file.text;
        if (!used.empty()) {
            if (whole != result)
                say_once(LogLevel::warning, path, text, path + ": is not used, because " + used + " comes first; delete it");
            continue;
        }
        if (beside && !as_built && !is_newer_than_library(path, plugin)) {
            say_once(LogLevel::warning, path, text,
                     path + ": is not used, because it is older than " + original_library(plugin).string() +
                         ", which has another text built in; delete it, or save it again to use it");
            continue;
        }
        if (is_types && file.text)
            require_same(path, whole, file.text,
                         std::string("plugin ") + plugin.id +
                             " was compiled with, so its structs may: build the plugin again, or set "
                             "CLARITY_KERNEL_PATH=embedded to run the kernels inside it");
        if (!as_built && (beside || place.kind == PluginPlace::sources))
            say_once(LogLevel::info, path, text,
                     path + ": is used; it differs from the text built into " + original_library(plugin).string());
        // What is built in has its parts in it, so that a line can be named only for a file without parts.
        if (as_built)
            remember(shown, path, std::move(text));
        else
            remember(shown, path, text, {}, included_parts(text).empty() && file.text ? file.text : "");
        used = path;
        result = whole;
    }
    if (used.empty()) result = remember(shown, {}, file.text ? file.text : "", original_library(plugin));
    return with_kernels(result);
}

std::string kernel_path(const std::string& shown_name) {
    Texts& all = texts();
    const std::lock_guard<std::mutex> lock(all.mutex);
    const auto found = all.last.find(shown_name);
    return found == all.last.end() ? std::string() : found->second.path;
}

std::string kernel_place(const std::string& shown_name) {
    Texts& all = texts();
    const std::lock_guard<std::mutex> lock(all.mutex);
    const auto found = all.last.find(shown_name);
    if (found == all.last.end()) return shown_name;
    const Texts::Last& last = found->second;
    if (!last.path.empty()) return last.path;
    return last.library.empty() ? shown_name : fs::path(shown_name).filename().string() + " inside " + last.library;
}

std::vector<EditedKernel> edited_kernels() {
    Texts& all = texts();
    const std::lock_guard<std::mutex> lock(all.mutex);
    std::vector<EditedKernel> edited;
    for (const auto& [name, last] : all.last)
        if (last.edited) edited.push_back({name, last.path, last.edited_line});
    return edited;
}

uint64_t kernel_text_revision() {
    Texts& all = texts();
    const std::lock_guard<std::mutex> lock(all.mutex);
    return all.revision;
}

std::vector<std::string> kernel_candidates(const std::vector<const rt_plugin*>& plugins) {
    std::vector<std::string> all;
    const fs::path kernels = places().kernels;
    if (!kernels.empty())
        for (const Embedded& file : kEmbedded) all.push_back((kernels / file.name).string());
    for (const rt_plugin* plugin : plugins)
        for (const rt_cl_file* file : kernels_of(*plugin))
            if (file->name)
                for (const PluginPlace& place : plugin_places(*plugin, file->name)) {
                    all.push_back(place.path.string());
                    add_parts(place.path, all);
                }
    return all;
}

}  // namespace clarity
