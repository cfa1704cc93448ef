#include "bench/gunzip.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "base/error.hpp"

namespace clarity {

TemporaryFile::~TemporaryFile() {
    if (!path_.empty()) unlink(path_.c_str());
}

TemporaryFile gunzip(const std::string& path) {
    const std::string stem = std::filesystem::path(path).stem().string();  // without .gz
    const auto fail = [&](const std::string& why) -> Error {
        return Error(Exit::import_failed, path + ": cannot be unpacked: " + why);
    };
    std::error_code error;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
    if (error) throw fail("no folder for temporary files: " + error.message());
    // The importer goes by the extension, which stays at the end.
    std::string name = (folder / ("clarity-XXXXXX-" + stem)).string();
    const int out = mkstemps(name.data(), static_cast<int>(stem.size() + 1));
    if (out < 0) throw fail(name + ": " + std::strerror(errno));
    TemporaryFile file(name);
    const pid_t child = fork();
    if (child == 0) {
        dup2(out, STDOUT_FILENO);
        execlp("gzip", "gzip", "-dc", "--", path.c_str(), static_cast<char*>(nullptr));
        _exit(127);
    }
    close(out);
    int status = -1;
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (child < 0) throw fail("no process can be started");
    if (WIFEXITED(status) && WEXITSTATUS(status) == 127) throw fail("the program gzip is not installed");
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw fail("gzip failed: the file is damaged, or the disk is full");
    return file;
}

}  // namespace clarity
