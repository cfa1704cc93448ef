#include "tools/lab/build.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/read_file.hpp"
#include "base/run_tool.hpp"
#include "base/text.hpp"
#include "worker/child.hpp"

namespace clarity::lab {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kToolBytes = uint64_t(2) << 30, kFileBytes = uint64_t(64) << 20;  // of each compiler
constexpr double kTryS = 60;                                                         // for tools that are tried
constexpr size_t kMostOutput = 6000;  // bytes of a compiler's messages that are kept

// Commands that run one after the other in a worker, and the folders that they may read and run.
struct Tools {
    std::vector<std::vector<std::string>> commands;
    std::vector<std::string> folders;
    std::string work, path;
    std::string bubblewrap;  // the program; "": not used
    uint64_t cpu_s = 0;
    CLARITY_MEMBERS(commands, folders, work, path, bubblewrap, cpu_s);
};

std::vector<std::string> in_bubblewrap(const Tools& tools) {
    std::vector<std::string> words = {tools.bubblewrap, "--unshare-all", "--die-with-parent", "--proc", "/proc",
                                      "--dev",          "/dev",          "--tmpfs",           "/tmp"};
    for (const std::string& folder : tools.folders) words.insert(words.end(), {"--ro-bind-try", folder, folder});
    words.insert(words.end(), {"--bind", tools.work, tools.work, "--chdir", tools.work});
    return words;
}

void run_tools(ParcelReader& arguments) {
    const auto tools = worker::arguments_in<Tools>(arguments);
    // Nothing of the grader's environment reaches the compilers.
    clearenv();
    setenv("PATH", tools.path.c_str(), 1);
    setenv("HOME", tools.work.c_str(), 1);
    setenv("TMPDIR", tools.work.c_str(), 1);
    setenv("LC_ALL", "C", 1);
    if (chdir(tools.work.c_str()) != 0) throw Error(Exit::failed, tools.work + ": " + std::strerror(errno));
    worker::WorkerLimits limits;
    limits.cpu_s = tools.cpu_s;
    limits.memory_bytes = kToolBytes;
    if (!tools.bubblewrap.empty()) {
        const rlimit memory{kToolBytes, kToolBytes}, file{kFileBytes, kFileBytes}, cpu{tools.cpu_s, tools.cpu_s};
        setrlimit(RLIMIT_AS, &memory);
        setrlimit(RLIMIT_FSIZE, &file);
        setrlimit(RLIMIT_CPU, &cpu);
    } else {
        worker::enter_tool_sandbox(tools.folders, tools.work, limits, kFileBytes);
    }
    for (const auto& command : tools.commands) {
        std::vector<std::string> words = tools.bubblewrap.empty() ? std::vector<std::string>() : in_bubblewrap(tools);
        words.insert(words.end(), command.begin(), command.end());
        if (!run_tool(words, words.front())) throw Error(Exit::failed, "`" + command[0] + " " + command[1] + "` failed");
    }
}

class ToolsJob : public worker::Job {
 public:
    explicit ToolsJob(double limit_s) : Job(kToolsJob, "the compiler", {limit_s, 0, 2 * kToolBytes}) {}
    std::string output;

 private:
    void on_output(const std::string& line) override {
        // Of the tools, what says that all is well is no news.
        if (line.rfind("-- ", 0) == 0 || line.rfind("[", 0) == 0 || line.find("gmake") == 0) return;
        if (output.size() < kMostOutput) output += printable_line(line) + "\n";
    }
};

Tools tools_for(const BuildTools& tools, Sandbox sandbox, const std::string& work, double cpu_s) {
    Tools job;
    job.folders = tools.folders, job.path = tools.path;
    job.work = fs::canonical(work).string();
    job.cpu_s = static_cast<uint64_t>(cpu_s);
    if (sandbox == Sandbox::bubblewrap) job.bubblewrap = tools.bubblewrap;
    return job;
}

// The regular file `path`, without following a link. Throws Refused.
std::string submitted(const std::string& path, const Lab::File& file) {
    struct stat status{};
    if (lstat(path.c_str(), &status) != 0) throw Refused(file.name + " is not there; hand it in under this name");
    if (!S_ISREG(status.st_mode)) throw Refused(file.name + " is no regular file: hand in the file itself, no link");
    if (static_cast<uint64_t>(status.st_size) > file.most_bytes)
        throw Refused(file.name + " has " + std::to_string(status.st_size) + " bytes; at most " +
                      std::to_string(file.most_bytes) + " are allowed");
    const int fd = open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0) throw Refused(file.name + " cannot be read: " + std::strerror(errno));
    close(fd);
    return read_file(path, file.most_bytes, Exit::failed);
}

bool is_part_of_name(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
}

// Puts blanks in the place of comments. It does not know strings: labs that forbid words forbid quotes, too.
void blank_comments(std::string& text) {
    const auto blank = [&](size_t from, size_t to) {
        for (size_t i = from; i < std::min(to, text.size()); ++i)
            if (text[i] != '\n') text[i] = ' ';
    };
    for (size_t at = text.find('/'); at != std::string::npos && at + 1 < text.size(); at = text.find('/', at + 1)) {
        if (text[at + 1] != '/' && text[at + 1] != '*') continue;
        const bool is_line = text[at + 1] == '/';
        const size_t end = text.find(is_line ? "\n" : "*/", at + 2);
        blank(at, end == std::string::npos ? text.size() : end + (is_line ? 0 : 2));
    }
}

}  // namespace

Sandbox find_sandbox() {
    static const Sandbox found = [] {
        const int status = std::system("bwrap --unshare-all --ro-bind / / /bin/true >/dev/null 2>&1");
        return status == 0 ? Sandbox::bubblewrap : worker::restricts_files() ? Sandbox::worker : Sandbox::limits;
    }();
    return found;
}
const char* sandbox_text(Sandbox sandbox) {
    switch (sandbox) {
        case Sandbox::bubblewrap:
            return "bubblewrap: compilers see only the system, themselves, the SDK and this submission";
        case Sandbox::worker:
            return "a worker's limits (Landlock, seccomp): compilers read only the system, themselves, the SDK and this "
                   "submission";
        default:
            return "resource limits alone: neither bubblewrap nor Landlock works here, so a submission may name files of the "
                   "teacher's in #include, and what the compiler says of them is left out";
    }
}

std::string forbidden_word(std::string text, const std::vector<std::string>& words) {
    blank_comments(text);
    const auto is_part = [&](size_t at) { return at < text.size() && is_part_of_name(text[at]); };
    for (const std::string& word : words) {
        // A word that ends in _ is the beginning of names.
        const bool is_name = is_part_of_name(word.front()), is_whole = is_name && word.back() != '_';
        for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
            if ((is_name && at > 0 && is_part(at - 1)) || (is_whole && is_part(at + word.size()))) continue;
            const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
            return "line " + std::to_string(line) + " has `" + word + "`";
        }
    }
    return {};
}

void collect(const Lab& lab, const std::string& from, const std::string& to) {
    fs::create_directories(to);
    for (const std::string& file : lab.given())
        fs::copy_file(file, to / fs::path(file).filename(), fs::copy_options::overwrite_existing);
    for (const Lab::File& file : lab.files) {
        const std::string text = submitted(from + "/" + file.name, file);
        if (const std::string why = file.is_kernel() ? forbidden_word(text, lab.forbidden) : ""; !why.empty())
            throw Refused(file.name + ": " + why + ", which this lab does not allow; page.md says why");
        write_text_file(to + "/" + file.name, text);
    }
}

void try_tools(const BuildTools& tools, Sandbox sandbox, const std::string& work, Progress& progress) {
    fs::create_directories(work);
    write_text_file(work + "/try.c", "int main(void) { return 0; }\n");
    write_text_file(work + "/try.cpp", "#include <vector>\nint main() { return int(std::vector<int>(1)[0]); }\n");
    const std::vector<std::vector<std::string>> commands = {{tools.cmake, "--version"},
                                                            {tools.make, "--version"},
                                                            {tools.c, "try.c", "-o", "try"},
                                                            {tools.cxx, "try.cpp", "-o", "try"}};
    for (const auto& command : commands) {
        Tools job = tools_for(tools, sandbox, work, kTryS);
        job.commands = {command};
        ToolsJob run(kTryS);
        try {
            run.run(job, progress);
        } catch (const Cancelled&) {
            throw;
        } catch (const Error& e) {
            std::string folders;
            for (const std::string& folder : tools.own_folders()) folders += (folders.empty() ? "" : ", ") + folder;
            throw Error(
                Exit::failed,
                std::string("a tool that builds submissions does not run in the sandbox: ") + e.what() +
                    "; besides the system's folders it may read " + (folders.empty() ? "none" : folders) +
                    "; name others that it needs by --tools FOLDER, or put the system's own CMake, make and g++ first in PATH",
                run.output);
        }
    }
}

std::string compile(const Lab& lab, const std::string& sources, const std::string& build, const BuildTools& tools,
                    Sandbox sandbox, Progress& progress) {
    const std::string library = build + "/" + lab.id + ".so";
    std::error_code ignored;
    fs::remove(library, ignored);
    fs::create_directories(build);
    Tools job = tools_for(tools, sandbox, fs::path(build).parent_path(), lab.compile_s);
    if (!fs::exists(build + "/CMakeCache.txt"))
        job.commands.push_back({tools.cmake, "-S", sources, "-B", build, "-G", tools.generator,
                                "-DCMAKE_MAKE_PROGRAM=" + tools.make, "-DCMAKE_C_COMPILER=" + tools.c,
                                "-DCMAKE_CXX_COMPILER=" + tools.cxx, "-DCMAKE_PREFIX_PATH=" + tools.sdk,
                                "-DCMAKE_BUILD_TYPE=Release"});
    job.commands.push_back({tools.cmake, "--build", build, "--clean-first"});
    ToolsJob run(lab.compile_s);
    try {
        run.run(job, progress);
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& e) {
        fs::remove(build + "/CMakeCache.txt", ignored);  // a configuration that failed would be taken for one
        // Without a sandbox for files a message may quote what the submission has included.
        throw Refused(std::string("it does not compile: ") + e.what(), sandbox == Sandbox::limits ? "" : run.output);
    }
    if (!fs::is_regular_file(fs::symlink_status(library))) throw Refused("the build makes no " + lab.id + ".so");
    return library;
}

const worker::JobKind kToolsJob = {
    "tools",
    "to build a plugin, run cmake",
    Exit::failed,
    false,
    LogLevel::debug,
    {"the compiler crashed ({how})", "the compiler ended ({how})", "the compiler did not come to its end within {how}",
     "the compiler used more than {how} of processor time", "the compiler needs more than {how} of memory",
     "the compiler was killed"},
    run_tools};

}  // namespace clarity::lab
