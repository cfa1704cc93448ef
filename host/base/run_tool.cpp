#include "base/run_tool.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.hpp"

namespace clarity {

bool run_tool(const std::vector<std::string>& words, const std::string& shown) {
    std::vector<char*> argv;
    for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    pid_t pid = -1;
    if (const int error = posix_spawnp(&pid, argv[0], nullptr, nullptr, argv.data(), environ))
        throw Error(Exit::failed, "`" + shown + "` cannot be run: " + std::strerror(error));
    int status = 0;
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace clarity
