#include "tools/lab/tools.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/text.hpp"

namespace clarity::lab {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSystemFolders[] = {"/usr", "/bin", "/sbin", "/lib", "/lib64", "/etc"};
constexpr const char* kSystemPath = "/usr/bin:/bin";
// They stand in the compiler's place and keep files elsewhere.
constexpr const char* kNotCompilers[] = {"ccache", "sccache", "distcc", "icecc"};

std::vector<std::string> split(const std::string& text, const char* separators) {
    std::vector<std::string> words;
    for (size_t at = 0; (at = text.find_first_not_of(separators, at)) != std::string::npos;) {
        const size_t end = std::min(text.find_first_of(separators, at), text.size());
        words.push_back(text.substr(at, end - at));
        at = end;
    }
    return words;
}

std::string path_variable() {
    const char* const path = std::getenv("PATH");
    return path && *path ? path : kSystemPath;
}

fs::path real(const fs::path& path) {
    std::error_code error;
    fs::path found = fs::canonical(path, error);
    return error ? fs::path() : found;
}

// Whether `inner` is `outer` or in it; both without links.
bool holds(const fs::path& outer, const fs::path& inner) {
    return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

// The folders that tools may read.
class Opened {
 public:
    explicit Opened(const std::vector<std::string>& closed) {
        const char* const home = std::getenv("HOME");
        if (home && *home) home_ = real(home);
        for (const std::string& folder : closed)
            if (fs::path found = real(folder); !found.empty()) closed_.push_back(std::move(found));
        for (const char* folder : kSystemFolders) open(folder);
    }
    // Where a closed folder is in it, all that is beside that.
    void open(const fs::path& path) {
        const fs::path target = real(path);
        const auto is = [&](auto test) { return std::any_of(closed_.begin(), closed_.end(), test); };
        if (target.empty() || holds(target, home_) || has(path)) return;
        if (is([&](const fs::path& closed) { return holds(closed, target); })) return;
        if (!is([&](const fs::path& closed) { return holds(target, closed); })) {
            folders_.push_back(path.string());
            return;
        }
        std::error_code error;
        for (const auto& entry : fs::directory_iterator(path, error)) open(entry.path());
    }
    // What is installed beside a program: /opt/gcc/lib of /opt/gcc/bin/g++.
    void open_program(const fs::path& program) {
        const fs::path folder = program.parent_path();
        open(folder);
        if (folder.filename() == "bin") open_prefix(folder.parent_path());
        std::ifstream file(program);
        std::string first;
        if (file.get() != '#' || file.get() != '!' || !std::getline(file, first)) return;
        const std::vector<std::string> words = split(first, " \t");
        if (const fs::path interpreter = words.empty() ? fs::path() : real(words[0]); !interpreter.empty())
            open_program(interpreter);
    }
    void open_prefix(const fs::path& prefix) {
        if (holds(real(prefix), home_)) return;
        for (const char* name : {"lib", "lib32", "lib64", "libexec", "include", "pyvenv.cfg"}) open(prefix / name);
    }
    bool has(const fs::path& path) const {
        return std::any_of(folders_.begin(), folders_.end(), [&](const std::string& folder) { return holds(folder, path); });
    }
    const std::vector<std::string>& folders() const { return folders_; }

 private:
    fs::path home_ = "/";
    std::vector<fs::path> closed_;
    std::vector<std::string> folders_;
};

// A program of PATH, by a path without links: in a sandbox links may lead nowhere. "": there is none.
std::string find_program(const std::string& name) {
    for (const std::string& folder : split(path_variable(), ":")) {
        const fs::path found = fs::path(folder) / name, target = real(found);
        if (target.empty() || fs::is_directory(target) || access(found.c_str(), X_OK) != 0) continue;
        // clang++ is a link to clang, which asks for the name that it is called by.
        const fs::path beside = target.parent_path() / name;
        if (access(beside.c_str(), X_OK) == 0) return beside.string();
        const auto* const end = std::end(kNotCompilers);
        if (std::find(std::begin(kNotCompilers), end, target.filename()) == end) return target.string();
    }
    return {};
}

std::string find_program(const std::vector<std::string>& names, const char* what, const char* package) {
    for (const std::string& name : names)
        if (std::string program = find_program(name); !program.empty()) return program;
    throw Error(Exit::failed, std::string(what) + " is not installed: no folder of PATH has " + names.front() + " (PATH is " +
                                  path_variable() + "); install it (Debian: " + package + "), or add its folder to PATH");
}

// What a program prints on stdout and stderr, without the environment of ours.
std::string output_of(const std::string& command) {
    std::string text;
    std::FILE* const pipe =
        popen(("/usr/bin/env -i PATH=" + shell_word(path_variable()) + " " + command + " 2>&1 </dev/null").c_str(), "re");
    if (!pipe) return text;
    char buffer[4096];
    while (const size_t count = std::fread(buffer, 1, sizeof buffer, pipe)) text.append(buffer, count);
    pclose(pipe);
    return text;
}

// Opens the folders that a compiler searches, as it says.
void open_compiler(Opened& opened, const std::string& compiler, const char* language) {
    opened.open_program(compiler);
    const std::string program = shell_word(compiler);
    std::istringstream lines(output_of(program + " -print-search-dirs") +
                             output_of(program + " -E -v -x " + language + " /dev/null"));
    for (std::string line; std::getline(lines, line);) {
        if (line.rfind("Configured with", 0) == 0) continue;  // folders of another machine
        for (const std::string& word : split(line, " \t:=\""))
            if (const fs::path found = word[0] == '/' ? real(word) : fs::path(); fs::is_directory(found))
                opened.open(found);
            else if (fs::is_regular_file(found))
                opened.open(found.parent_path());
    }
}

}  // namespace

std::vector<std::string> BuildTools::own_folders() const {
    std::vector<std::string> own;
    for (const std::string& folder : folders)
        if (std::none_of(std::begin(kSystemFolders), std::end(kSystemFolders),
                         [&](const char* system) { return holds(system, folder); }))
            own.push_back(folder);
    return own;
}

BuildTools find_build_tools(const std::string& sdk, const std::vector<std::string>& more,
                            const std::vector<std::string>& closed, const std::string& work) {
    BuildTools tools;
    tools.sdk = sdk;
    tools.bubblewrap = find_program("bwrap");
    Opened opened(closed);
    // `cmake` may be a script of Python's, which starts the program.
    const std::string cmake = find_program({"cmake"}, "CMake", "cmake"), question = work + "/where.cmake";
    write_text_file(question, "message(\"${CMAKE_COMMAND}\\n${CMAKE_ROOT}\")\n");
    const std::vector<std::string> answer = split(output_of(shell_word(cmake) + " -P " + shell_word(question)), "\n");
    if (answer.size() != 2 || real(answer[0]).empty() || real(answer[1]).empty())
        throw Error(Exit::failed, cmake + ": does not say where it is installed, so submissions cannot be built; it printed: " +
                                      (answer.empty() ? "nothing" : answer.front()));
    tools.cmake = real(answer[0]).string();
    opened.open_program(tools.cmake);
    opened.open(real(answer[1]));
    tools.cxx = find_program({"c++", "g++", "clang++"}, "A C++ compiler", "g++");
    open_compiler(opened, tools.cxx, "c++");
    tools.c = find_program({"cc", "gcc", "clang"}, "A C compiler", "gcc");
    open_compiler(opened, tools.c, "c");
    tools.make = find_program({"make", "gmake", "ninja"}, "make", "make");
    tools.generator = fs::path(tools.make).filename() == "ninja" ? "Ninja" : "Unix Makefiles";
    opened.open_program(tools.make);
    for (const char* name : {"include/clarity", "lib", "lib64"}) opened.open(real(sdk) / name);
    for (const std::string& folder : more) {
        if (real(folder).empty()) throw Error(Exit::usage, "--tools " + folder + ": there is no such folder");
        opened.open(real(folder));
    }
    for (const std::string& folder : split(path_variable(), ":"))
        if (opened.has(real(folder))) tools.path += folder + ":";
    tools.path += kSystemPath;
    tools.folders = opened.folders();
    return tools;
}

}  // namespace clarity::lab
