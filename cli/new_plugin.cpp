// clarity new-plugin: makes a folder with a plugin that builds and works, from the templates in share/clarity/template.
//
// A kind of plugin is a folder of templates. In names and texts of its files, my_KIND and MY_KIND become the id.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "base/files/read_file.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "plugin/plugin_check.hpp"

namespace clarity {
namespace {

namespace fs = std::filesystem;

// The folder that the program is installed into; of a program in a build folder, that folder.
fs::path program_prefix() {
    return program_file().parent_path().parent_path();
}

bool is_installed() {
    std::error_code error;
    return !fs::exists(program_prefix() / "CMakeCache.txt", error);
}

std::vector<fs::path> entries_of(const fs::path& folder) {
    std::vector<fs::path> entries;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
        entries.push_back(entry->path());
    std::sort(entries.begin(), entries.end());
    return entries;
}

fs::path template_folder(const std::string& kind) {
    const fs::path all = program_prefix() / "share/clarity/template";
    std::string kinds;
    for (const fs::path& folder : entries_of(all)) {
        if (folder.filename() == kind && !entries_of(folder).empty()) return folder;
        kinds += (kinds.empty() ? "" : ", ") + folder.filename().string();
    }
    if (kinds.empty())
        throw Error(Exit::failed, "new-plugin: no templates in " + all.string() + ": install Clarity with its SDK again");
    throw Error(Exit::usage, "new-plugin " + kind + ": no such kind of plugin; there are " + kinds);
}

void check_id(const std::string& id) {
    if (!is_plugin_id(id))
        throw Error(Exit::usage, "new-plugin: '" + id +
                                     "' cannot be an id: take at most 32 lower-case letters, digits and _, a letter first");
    if (id == "rt" || id.compare(0, 3, "rt_") == 0)
        throw Error(Exit::usage, "new-plugin: '" + id + "' cannot be an id: names with rt_ are the host's; take another one");
}

// Replaces `from` where it begins a word: my_accel_block becomes my_tree_block, dummy_accel stays.
std::string with_words(const std::string& text, const std::string& from, const std::string& to) {
    std::string out;
    size_t done = 0;
    for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + from.size())) {
        if (at > 0 && (std::isalnum(static_cast<unsigned char>(text[at - 1])) || text[at - 1] == '_')) continue;
        out += text.substr(done, at - done) + to;
        done = at + from.size();
    }
    return out + text.substr(done);
}

std::string upper(std::string text) {
    for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
}

// Keeps signals away until the folder is whole or gone.
class SignalsWait {
 public:
    SignalsWait() {
        sigset_t set;
        sigemptyset(&set);
        for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set, number);
        sigprocmask(SIG_BLOCK, &set, &before_);
    }
    ~SignalsWait() { sigprocmask(SIG_SETMASK, &before_, nullptr); }

 private:
    sigset_t before_;
};

// Returns false, and errno, if it cannot.
bool rename_without_replacing(const fs::path& from, const fs::path& to) {
    if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return true;
    return errno == EINVAL && std::rename(from.c_str(), to.c_str()) == 0;  // the file system does not know how
}

// A folder under a temporary name. What is not moved to its place is removed.
class NewFolder {
 public:
    explicit NewFolder(const fs::path& place) : place_(place) {
        std::error_code error;
        if (fs::exists(fs::symlink_status(place, error))) {
            if (!fs::is_directory(place, error)) fail("it is there already, and is no folder; take another name");
            const bool empty = fs::is_empty(place, error);
            if (error) fail("it cannot be read: " + error.message());
            if (!empty) fail("it is there already, and is not empty; take another folder, or remove it");
            exists_ = true;
        } else if (!fs::is_directory(place.parent_path(), error)) {
            fail("the folder " + place.parent_path().string() + " is not there; make it first");
        }
        std::string name = ((exists_ ? place : place.parent_path()) / ".new-plugin-XXXXXX").string();
        if (!mkdtemp(name.data())) fail("nothing can be written there: " + std::string(std::strerror(errno)));
        temporary_ = name;
        const mode_t mask = umask(0);
        umask(mask);
        chmod(name.c_str(), 0777 & ~mask);
    }
    ~NewFolder() {
        std::error_code ignored;
        if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
    }
    void write(const std::string& name, const std::string& text) {
        std::ofstream file(temporary_ / name, std::ios::binary);
        file << text;
        file.close();
        if (!file) fail("writing " + name + " failed: " + std::strerror(errno) + "; nothing was made");
        names_.push_back(name);
    }
    // Gives the folder its name. An empty folder that is there gets the files, because it may be a shell's working folder.
    void move_to_place() {
        if (!exists_) {
            if (std::rename(temporary_.c_str(), place_.c_str()) != 0) fail(std::strerror(errno));
            temporary_.clear();
            return;
        }
        for (size_t i = 0; i < names_.size(); ++i) {
            if (rename_without_replacing(temporary_ / names_[i], place_ / names_[i])) continue;
            const std::string why = std::strerror(errno);
            for (size_t made = 0; made < i; ++made) unlink((place_ / names_[made]).c_str());
            fail(names_[i] + ": " + why + "; nothing was made");
        }
    }

 private:
    [[noreturn]] void fail(const std::string& why) const {
        throw Error(Exit::failed, "new-plugin: the plugin cannot be made in " + place_.string() + ": " + why);
    }
    const fs::path place_;
    fs::path temporary_;
    bool exists_ = false;
    std::vector<std::string> names_;
};

void warn_of_taken_id(const PluginRegistry& plugins, const std::string& id) {
    for (const PluginRecord& record : plugins.records())
        if (record.plugin && record.plugin->id == id)
            log(LogLevel::warning, "the id '" + id + "' is taken by " + record.path +
                                       ": of two libraries with one id, the first that is found is used (`clarity plugins`)");
}

// How a shell finds this program: by its name, if the folder is in PATH.
std::string program_name() {
    const fs::path program = program_file();
    const char* path = std::getenv("PATH");
    const std::string folders = ":" + std::string(path ? path : "") + ":";
    const bool found = folders.find(":" + program.parent_path().string() + ":") != std::string::npos;
    return found ? program.filename().string() : shell_word(program.string());
}

void print_next_steps(const std::string& folder, const std::string& id) {
    const fs::path prefix = program_prefix();
    std::string found_in;
    if (!is_installed())
        found_in = " -DCMAKE_PREFIX_PATH=PREFIX   # once: cmake --install " + shell_word(prefix.string()) + " --prefix PREFIX";
    else if (prefix != "/usr" && prefix != "/usr/local")
        found_in = " -DCMAKE_PREFIX_PATH=" + shell_word(prefix.string());
    print_text(
        "%s is a plugin now. Build it and check it; its README.md continues.\n"
        "  cd %s\n  cmake -S . -B build%s\n  cmake --build build\n  %s check ./build/%s.so --quick\n",
        folder.c_str(), shell_word(folder).c_str(), found_in.c_str(), program_name().c_str(), id.c_str());
}

}  // namespace

int run_new_plugin(const PluginRegistry& plugins, const NewPluginCommand& command) {
    const fs::path from = template_folder(command.kind);
    check_id(command.id);
    const std::string folder = command.folder.empty() ? command.id : command.folder;
    fs::path place = fs::absolute(folder).lexically_normal();
    if (!place.has_filename()) place = place.parent_path();
    warn_of_taken_id(plugins, command.id);
    const std::string word = "my_" + command.kind;
    const auto renamed = [&](const std::string& text) {
        return with_words(with_words(text, word, command.id), upper(word), upper(command.id));
    };
    {
        const SignalsWait wait;
        NewFolder made(place);
        for (const fs::path& file : entries_of(from))
            made.write(renamed(file.filename().string()), renamed(read_file(file.string(), kMaxTextFileBytes, Exit::failed)));
        made.move_to_place();
    }
    print_next_steps(folder, command.id);
    return static_cast<int>(Exit::done);
}

}  // namespace clarity
