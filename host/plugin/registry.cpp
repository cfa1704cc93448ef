#include "plugin/registry.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <set>

#include "base/files/library_files.hpp"
#include "base/files/packed_file.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "base/timeline.hpp"
#include "plugin/elf_file.hpp"
#include "plugin/plugin_check.hpp"
#include "plugin/plugin_copy.hpp"
#include "plugin/trust.hpp"
#include "scene/surface_models.hpp"

namespace clarity {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSymbol = "rt_plugin_v1";
constexpr const char* kKindFolders[] = {"importers", "accel", "primitives", "surfaces"};

std::string dlopen_advice(const std::string& error) {
    if (error.find("undefined symbol") != std::string::npos) return "; link it with -Wl,--no-undefined to see what is missing";
    if (error.find("No such file") != std::string::npos) return "; install the library that it needs (`ldd` on it lists them)";
    return {};
}

// Fills the record of record.path.
Problem load_checked(PluginRecord& record) {
    const std::string& path = record.path;
    // Read the version from the file first: dlopen would run the library's constructors before the check.
    ElfSymbol symbol;
    if (Problem why = read_elf_symbol(path, kSymbol, symbol)) return why;
    if (!symbol.found)
        return std::string("exports no symbol ") + kSymbol +
               ", so it is no plugin of clarity; define it (docs/plugins.md) and export it";
    if (!symbol.is_data)
        return std::string("exports ") + kSymbol +
               " as a function, expected data: declare it as `const rt_plugin rt_plugin_v1`";
    if (Problem why = check_plugin_head(symbol.head, symbol.bytes)) return why;
    if (Problem why = try_to_load(path)) return why;
    const std::string full = fs::absolute(path).string();  // dlopen would look up a bare name in the system's library folders
    void* library = dlopen(full.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        const char* error = dlerror();
        return std::string("cannot be loaded: ") + (error ? error : "no reason given") + dlopen_advice(error ? error : "");
    }
    const auto* plugin = static_cast<const rt_plugin*>(dlsym(library, kSymbol));
    if (!plugin)
        return std::string("exports no symbol ") + kSymbol + " after loading, although its file contains it; build it again";
    // Check again what is really mapped: the file may have been replaced in between, and a constructor may have changed the
    // data.
    uint32_t head[4];
    std::memcpy(head, plugin, sizeof head);
    if (Problem why = check_plugin_head(head, symbol.bytes)) return why;
    Problem why;
    const rt_plugin* const copy = copy_plugin(*plugin, why);
    if (copy) why = check_plugin(*copy);
    if (!why) record.plugin = copy;
    return why;
}

std::string environment(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

std::string executable_folder() {
    return program_file().parent_path().string();
}

// The libraries in one folder, sorted by name. `missing_ok`: the folder is only a usual place for plugins; the user did not
// name it.
std::vector<std::string> libraries_in(const fs::path& folder, bool missing_ok) {
    std::vector<std::string> found;
    std::error_code error;
    fs::directory_iterator entry(folder, error), end;
    if (error) {
        if (!missing_ok || (error != std::errc::no_such_file_or_directory && error != std::errc::not_a_directory))
            log(LogLevel::warning, folder.string() + ": no plugins are read from this folder: " + error.message());
        return found;
    }
    for (; !error && entry != end; entry.increment(error))
        if (entry->path().extension() == ".so") found.push_back(entry->path().string());
    if (error) log(LogLevel::warning, folder.string() + ": the folder could not be read to its end: " + error.message());
    std::sort(found.begin(), found.end());
    return found;
}

// Collects libraries; a file that is found in several ways is collected once.
class Search {
 public:
    void add_file(const std::string& path) {
        std::error_code error;
        const fs::path real = fs::canonical(path, error);
        if (seen_.insert(error ? path : real.string()).second) paths_.push_back(path);
    }
    // A folder may also have the layout of the build folder, with libraries in a folder for each kind below it.
    void add_folder(const fs::path& folder, bool missing_ok) {
        for (const std::string& path : libraries_in(folder, missing_ok)) add_file(path);
        for (const char* kind : kKindFolders)
            for (const std::string& path : libraries_in(folder / kind, true)) add_file(path);
    }
    const std::vector<std::string>& paths() const { return paths_; }

 private:
    std::set<std::string> seen_;
    std::vector<std::string> paths_;
};

void search_environment(Search& search) {
    const std::string list = environment("CLARITY_PLUGIN_PATH");
    for (size_t begin = 0; begin <= list.size();) {
        const size_t end = std::min(list.find(':', begin), list.size());
        // An empty element is ignored. In PATH it would mean the working directory, which is never searched here.
        if (end > begin) search.add_folder(list.substr(begin, end - begin), false);
        begin = end + 1;
    }
}

void search_user_data(Search& search) {
    std::string data = environment("XDG_DATA_HOME");
    if (data.empty() || data[0] != '/') {  // the XDG specification ignores relative paths
        const std::string home = environment("HOME");
        if (home.empty() || home[0] != '/') return;
        data = home + "/.local/share";
    }
    search.add_folder(fs::path(data) / "clarity" / "plugins", true);
}

// The plugin folders of a program, which need not exist.
std::vector<fs::path> folders_of(const fs::path& program_folder) {
    std::vector<fs::path> folders;
    if (program_folder.empty()) return folders;
#ifdef CLARITY_LIBRARIES_FROM_PROGRAM
    folders.push_back((program_folder / CLARITY_LIBRARIES_FROM_PROGRAM / "clarity" / "plugins").lexically_normal());
#endif
    folders.push_back((program_folder / "../lib/clarity/plugins").lexically_normal());  // the layout of the build folder
    return folders;
}

void search_own_folders(Search& search) {
    for (const fs::path& folder : folders_of(executable_folder())) search.add_folder(folder, true);
}

std::string key_of(const rt_plugin& plugin) {
    return std::string(plugin_kind(plugin)) + ' ' + plugin.id;
}

std::string lower_extension(const std::string& path) {
    std::string extension = fs::path(path).extension().string();
    if (!extension.empty()) extension.erase(0, 1);
    return lower(extension);
}

// The first bytes of a file, or of what is packed in it.
std::vector<uint8_t> read_head(const std::string& path) {
    std::vector<uint8_t> head(4096);
    if (is_packed(path)) {
        std::string content;
        (void)unpack_head(path, head.size(), content);  // damage is reported when the file is read
        return {content.begin(), content.end()};
    }
    size_t bytes = 0;
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // opening a pipe must not block
    struct stat status{};
    if (file >= 0 && fstat(file, &status) == 0 && S_ISREG(status.st_mode)) {
        for (ssize_t got = 0; bytes < head.size(); bytes += static_cast<size_t>(got)) {
            got = read(file, head.data() + bytes, head.size() - bytes);
            if (got < 0 && errno == EINTR)
                got = 0;
            else if (got <= 0)
                break;
        }
    }
    if (file >= 0) close(file);
    head.resize(bytes);
    return head;
}

// Certainty that the importer can read a file. The first bytes say more than the name; the name decides if they say nothing.
int certainty(const rt_importer& importer, const std::string& extension, const std::vector<uint8_t>& head) {
    constexpr int kByName = 30, kWithoutName = 50;
    bool named = false;
    for (const char* const* e = importer.extensions; *e && !named; ++e) named = extension == *e;
    int probed = 0;
    try {
        if (importer.probe && !head.empty()) probed = std::clamp(importer.probe(head.data(), head.size()), 0, 100);
    } catch (...) {  // plugins must not throw; one that does counts as undecided
        probed = 0;
    }
    if (named) return kByName + probed;
    return probed >= kWithoutName ? probed : 0;
}

}  // namespace

PluginRecord load_plugin(const std::string& path) {
    PluginRecord record;
    record.path = record.loaded = path;
    try {
        record.why = load_checked(record).text();
    } catch (const std::exception& e) {
        record.why = std::string("could not be examined: ") + e.what();
    }
    return record;
}

bool is_own_library(const std::string& path) {
    std::error_code error;
    const fs::path library = fs::canonical(path, error);
    if (error) return false;
    std::vector<fs::path> folders = folders_of(executable_folder());
    if (const std::string worker = environment("CLARITY_WORKER"); !worker.empty())
        for (fs::path& folder : folders_of(fs::canonical(worker, error).parent_path())) folders.push_back(std::move(folder));
    for (const fs::path& folder : folders) {
        if (library.parent_path() == fs::canonical(folder, error) && !error) return true;
        for (const char* kind : kKindFolders)
            if (library.parent_path() == fs::canonical(folder / kind, error) && !error) return true;
    }
    return false;
}

namespace {

// The usable plugins that have this table, in the order in which they were found.
template <class Table>
std::vector<const rt_plugin*> usable(const std::vector<PluginRecord>& records, Table rt_plugin::* table) {
    std::vector<const rt_plugin*> list;
    for (const PluginRecord& record : records)
        if (record.plugin && !record.shadowed && record.plugin->*table) list.push_back(record.plugin);
    return list;
}

template <class Table>
const rt_plugin* find(const std::vector<PluginRecord>& records, Table rt_plugin::* table, std::string_view id) {
    for (const rt_plugin* plugin : usable(records, table))
        if (id == plugin->id) return plugin;
    return nullptr;
}

template <class Table>
std::vector<const rt_plugin*> sorted(const std::vector<PluginRecord>& records, Table rt_plugin::* table) {
    std::vector<const rt_plugin*> list = usable(records, table);
    std::sort(list.begin(), list.end(), [](const rt_plugin* a, const rt_plugin* b) { return std::strcmp(a->id, b->id) < 0; });
    return list;
}

// Of several libraries with one id the first counts.
void shadow_later_ones(std::vector<PluginRecord>& records) {
    std::set<std::string> taken;
    for (PluginRecord& record : records) record.shadowed = record.plugin && !taken.insert(key_of(*record.plugin)).second;
}

// Refuses topologies without a layout that packs them, so that nobody can choose a structure that cannot be traced.
void link_layouts(std::vector<PluginRecord>& records) {
    for (PluginRecord& record : records) {
        if (!record.plugin || !record.plugin->accel || !record.plugin->accel->layout) continue;
        const char* const id = record.plugin->accel->layout;
        const rt_plugin* const layout = find(records, &rt_plugin::accel, id);
        if (layout && layout->accel->pack) continue;
        record.plugin = nullptr;
        record.why = std::string("its layout '") + id + "' " +
                     (layout ? "has no `pack`, so it cannot take a tree of another plugin: name one of "
                             : "was not found: load that plugin, or name one of ");
        std::string packs;
        for (const rt_plugin* other : sorted(records, &rt_plugin::accel))
            if (other->accel->pack) packs += (packs.empty() ? "" : ", ") + std::string(other->id);
        record.why += packs.empty() ? "those with `pack` (there are none)" : packs;
    }
}

// Makes the models of surfaces known. Refuses a plugin if its keys are taken, or if there are too many models.
void add_surfaces(std::vector<PluginRecord>& records) {
    for (PluginRecord& record : records) {
        const rt_surface* const surface = record.plugin && !record.shadowed ? rt_surface_of(record.plugin) : nullptr;
        if (!surface) continue;
        record.why = add_surface_model(*record.plugin, *surface).text();
        if (!record.why.empty()) record.plugin = nullptr;
    }
}

std::string kind_and_id(const rt_plugin& plugin) {
    return std::string(plugin_kind(plugin)) + " '" + plugin.id + "'";
}

}  // namespace

PluginRegistry PluginRegistry::discover(const std::vector<std::string>& plugin_files, bool log_refused) {
    const timeline::Scope span("load", "find plugins");
    Search search;
    for (const std::string& file : plugin_files) search.add_file(file);
    const size_t named = search.paths().size();
    search_environment(search);
    search_user_data(search);
    search_own_folders(search);

    PluginRegistry registry;
    std::vector<PluginRecord>& records = registry.list_->records;
    for (const std::string& path : search.paths()) records.push_back(load_plugin(path));
    shadow_later_ones(records);
    link_layouts(records);
    add_surfaces(records);
    for (size_t i = 0; log_refused && i < records.size(); ++i)
        if (!records[i].plugin)
            log(i < named ? LogLevel::error : LogLevel::warning, "plugin refused: " + records[i].path + ": " + records[i].why);
    return registry;
}

PluginRegistry PluginRegistry::of(const std::vector<std::string>& plugin_files) {
    PluginRegistry registry;
    std::vector<PluginRecord>& records = registry.list_->records;
    for (const std::string& file : plugin_files) records.push_back(load_plugin(file));
    link_layouts(records);
    add_surfaces(records);
    for (const PluginRecord& record : records)
        if (!record.plugin) log(LogLevel::warning, "plugin refused: " + record.path + ": " + record.why);
    return registry;
}

Problem PluginRegistry::replace(const PluginRecord& rebuilt) {
    const std::lock_guard<std::mutex> lock(list_->mutex);
    std::vector<PluginRecord> next = list_->records;
    const auto place =
        std::find_if(next.begin(), next.end(), [&](const PluginRecord& record) { return record.path == rebuilt.path; });
    if (place == next.end()) return "no library of this path was found when the program started; start it again";
    if (place->plugin && key_of(*place->plugin) != key_of(*rebuilt.plugin))
        return "it was the " + kind_and_id(*place->plugin) + " and is the " + kind_and_id(*rebuilt.plugin) +
               " now; start the program again to use it";
    const unsigned replaced = place->replaced + 1;
    *place = rebuilt;
    place->replaced = replaced;
    const size_t at = size_t(place - next.begin());
    shadow_later_ones(next);
    link_layouts(next);
    for (size_t i = 0; i < next.size(); ++i) {
        if (next[i].plugin || (i != at && !list_->records[i].plugin)) continue;
        if (i == at) return next[i].why;
        return "it packs no trees any more, and " + next[i].path + " needs that: give it its `pack` back";
    }
    add_surfaces(next);  // last, because it changes what all see
    if (!next[at].plugin) return next[at].why;
    list_->records = std::move(next);
    return {};
}

std::vector<PluginRecord> PluginRegistry::records() const {
    const std::lock_guard<std::mutex> lock(list_->mutex);
    return list_->records;
}

const char* plugin_kind(const rt_plugin& plugin) {
    return plugin.accel ? "accel" : plugin.importer ? "importer" : plugin.primitive ? "primitive" : "surface";
}

const rt_plugin* PluginRegistry::accel(std::string_view id) const {
    const std::lock_guard<std::mutex> lock(list_->mutex);
    return find(list_->records, &rt_plugin::accel, id);
}
const rt_plugin* PluginRegistry::importer(std::string_view id) const {
    const std::lock_guard<std::mutex> lock(list_->mutex);
    return find(list_->records, &rt_plugin::importer, id);
}
const rt_plugin* PluginRegistry::primitive(std::string_view id) const {
    const std::lock_guard<std::mutex> lock(list_->mutex);
    return find(list_->records, &rt_plugin::primitive, id);
}

const rt_plugin& PluginRegistry::layout_of(const rt_plugin& plugin) const {
    const rt_plugin* const layout = plugin.accel->layout ? accel(plugin.accel->layout) : nullptr;
    return layout ? *layout : plugin;
}

std::vector<const rt_plugin*> PluginRegistry::accels() const {
    const std::lock_guard<std::mutex> lock(list_->mutex);
    return sorted(list_->records, &rt_plugin::accel);
}
std::vector<const rt_plugin*> PluginRegistry::importers() const {
    const std::lock_guard<std::mutex> lock(list_->mutex);
    return sorted(list_->records, &rt_plugin::importer);
}
std::vector<const rt_plugin*> PluginRegistry::primitives() const {
    const std::lock_guard<std::mutex> lock(list_->mutex);
    return sorted(list_->records, &rt_plugin::primitive);
}
std::vector<const rt_plugin*> PluginRegistry::with_kernels() const {
    std::vector<const rt_plugin*> list = accels();
    for (const rt_plugin* plugin : primitives()) list.push_back(plugin);
    for (const PluginRecord& record : records())
        if (record.plugin && !record.shadowed && rt_surface_of(record.plugin)) list.push_back(record.plugin);
    return list;
}

const rt_plugin* PluginRegistry::importer_for(const std::string& path) const {
    const std::string extension = lower_extension(name_without_gz(path));
    const std::vector<uint8_t> head = read_head(path);
    const rt_plugin* best = nullptr;
    int best_certainty = 0;
    for (const PluginRecord& record : records()) {
        if (!record.plugin || record.shadowed || !record.plugin->importer) continue;
        const int sure = certainty(*record.plugin->importer, extension, head);
        if (sure > best_certainty) {
            best_certainty = sure;
            best = record.plugin;
        }
    }
    return best;
}

}  // namespace clarity
