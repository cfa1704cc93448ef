#include "device/kernel_files.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>

#include "base/error.hpp"
#include "base/read_file.hpp"
#include "device/kernel_includes.hpp"

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
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    const fs::path build = program.parent_path().parent_path();
    if (error || !fs::exists(build / "CMakeCache.txt", error)) return {};
    fs::path folder = build;
    for (int up = 0; up < 2; ++up) {
        folder = folder.parent_path();
        if (fs::exists(folder / "cl" / "CONTRACT.md", error)) return folder / "cl";
    }
    return {};
}

// A plugin's folder below that of the sources.
std::string folder_of(const rt_plugin& plugin) {
    return std::string(plugin.primitive ? "plugins/primitives/" : "plugins/accel/") + plugin.id;
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

fs::path library_folder(const rt_plugin& plugin) {
    Dl_info info{};
    if (dladdr(&plugin, &info) == 0 || !info.dli_fname) return {};
    return fs::absolute(info.dli_fname).lexically_normal().parent_path();
}

// Returns where a plugin's file may be, in order of precedence.
std::vector<fs::path> plugin_places(const rt_plugin& plugin, const char* name) {
    std::vector<fs::path> all;
    const Places where = places();
    if (!where.kernels.empty()) all.push_back(where.plugin(plugin) / name);
    if (where.beside_libraries)
        if (const fs::path folder = library_folder(plugin); !folder.empty()) all.push_back(folder / name);
    return all;
}

// The last text of each file, by the name that the compiler sees.
struct Texts {
    struct Last {
        std::string path;  // "": embedded
        size_t hash;
    };
    std::mutex mutex;
    std::map<std::string, Last> last;
    uint64_t revision = 0;
};
Texts& texts() {
    static Texts* const all = new Texts;  // never freed: threads that outlive main() may still compile
    return *all;
}

// Records a text. The revision grows if it differs from the last one of that name.
std::string remember(const std::string& shown_name, const fs::path& path, std::string text) {
    Texts& all = texts();
    const std::lock_guard<std::mutex> lock(all.mutex);
    const Texts::Last now{path.string(), std::hash<std::string>()(text)};
    const auto [entry, first] = all.last.insert({shown_name, now});
    if (!first && entry->second.hash != now.hash) ++all.revision;
    entry->second = now;
    return text;
}

void require_same(const fs::path& path, const std::string& text, const std::string& compiled, const std::string& rebuild) {
    if (text == compiled) return;
    const auto differ = std::mismatch(text.begin(), text.end(), compiled.begin(), compiled.end()).first;
    const auto line = static_cast<unsigned>(1 + std::count(text.begin(), differ, '\n'));
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
        return remember("cl/" + name, where.kernels / name, std::move(text));
    }
    if (embedded) return remember("cl/" + name, {}, embedded);
    throw Error(Exit::kernel_build_failed, "no kernel source `" + name + "` in this program" +
                                               (where.kernels.empty() ? std::string() : " or in " + where.kernels.string()) +
                                               ": build the program again");
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
    std::string text;
    if (file.name)
        for (const fs::path& path : plugin_places(plugin, file.name)) {
            if (!read_if_present(path, text)) continue;
            const std::string whole = with_parts(text, shown, path);
            if (plugin.accel && &file == &plugin.accel->types && file.text)
                require_same(path, whole, file.text,
                             std::string("plugin ") + plugin.id +
                                 " was compiled with, so its structs may: build the plugin again and restart, or set "
                                 "CLARITY_KERNEL_PATH=embedded to run the kernels inside it");
            remember(shown, path, std::move(text));
            return with_kernels(whole);
        }
    return with_kernels(remember(shown, {}, file.text ? file.text : ""));
}

std::string kernel_path(const std::string& shown_name) {
    Texts& all = texts();
    const std::lock_guard<std::mutex> lock(all.mutex);
    const auto found = all.last.find(shown_name);
    return found == all.last.end() ? std::string() : found->second.path;
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
                for (const fs::path& path : plugin_places(*plugin, file->name)) {
                    all.push_back(path.string());
                    add_parts(path, all);
                }
    return all;
}

}  // namespace clarity
