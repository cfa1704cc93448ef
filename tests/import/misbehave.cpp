#include "misbehave.hpp"

#include <fcntl.h>
#include <netinet/in.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <vector>

namespace test_importer {
namespace {

// Volatile and not a tail call, so that no optimiser removes the recursion.
int recurse(volatile int depth) {
    volatile char frame[512];
    frame[depth % 512] = static_cast<char>(depth);
    if (depth < 0) return 0;  // never true, but the compiler does not know it
    return recurse(depth + 1) + frame[(depth + 7) % 512];
}

[[noreturn]] void allocate_without_end() {
    std::vector<char*> blocks;
    for (;;) {
        constexpr size_t bytes = 8u << 20;
        char* block = new char[bytes];
        std::memset(block, 1, bytes);
        blocks.push_back(block);
    }
}

void throw_from_a_thread(const std::string& text) {
    std::thread([&] { throw std::runtime_error(text); }).join();
}

}  // namespace

bool misbehave(const std::string& what, const std::string& argument) {
    if (what == "crash") {
        volatile uintptr_t nowhere = 16;
        *reinterpret_cast<volatile int*>(nowhere) = 1;
    } else if (what == "abort") {
        std::abort();
    } else if (what == "recurse") {
        volatile int depth = recurse(0);
        (void)depth;
    } else if (what == "allocate") {
        allocate_without_end();
    } else if (what == "hang") {
        for (volatile unsigned i = 0;; i = i + 1) {
        }
    } else if (what == "sleep") {
        for (;;) std::this_thread::sleep_for(std::chrono::seconds(1));
    } else if (what == "exit") {
        std::_Exit(std::atoi(argument.c_str()));
    } else if (what == "throw") {
        throw std::runtime_error(argument);
    } else if (what == "throw_number") {
        throw 7;
    } else if (what == "throw_in_thread") {
        throw_from_a_thread(argument);
    } else {
        return false;
    }
    return true;
}

bool try_forbidden(const std::string& what, const std::string& argument, std::string& outcome) {
    errno = 0;
    long result = -1;
    if (what == "write") {
        result = open(argument.c_str(), O_WRONLY | O_CREAT, 0644);
    } else if (what == "append") {
        result = open(argument.c_str(), O_RDWR | O_APPEND);
    } else if (what == "unlink") {
        result = unlink(argument.c_str());
    } else if (what == "rename") {
        result = rename(argument.c_str(), (argument + ".moved").c_str());
    } else if (what == "mkdir") {
        result = mkdir(argument.c_str(), 0755);
    } else if (what == "chmod") {
        result = chmod(argument.c_str(), 0777);
    } else if (what == "truncate") {
        result = truncate(argument.c_str(), 0);
    } else if (what == "symlink") {
        result = symlink("/etc/passwd", argument.c_str());
    } else if (what == "read") {
        result = open(argument.c_str(), O_RDONLY);
    } else if (what == "socket") {
        result = socket(AF_INET, SOCK_STREAM, 0);
    } else if (what == "unix_socket") {
        result = socket(AF_UNIX, SOCK_STREAM, 0);
    } else if (what == "fork") {
        const pid_t child = fork();
        if (child == 0) std::_Exit(0);
        result = child;
    } else if (what == "exec") {
        char* const none[] = {nullptr};
        result = execve("/bin/true", none, none);
    } else if (what == "spawn") {
        pid_t child = 0;
        char name[] = "true";
        char* const arguments[] = {name, nullptr};
        const int error = posix_spawn(&child, "/bin/true", nullptr, nullptr, arguments, nullptr);
        errno = error;
        result = error == 0 ? 0 : -1;
    } else if (what == "kill_parent") {
        result = kill(getppid(), 0);
    } else if (what == "executable_memory") {
        result = mmap(nullptr, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) == MAP_FAILED ? -1 : 0;
    } else if (what == "raise_limit") {
        const rlimit unlimited = {RLIM_INFINITY, RLIM_INFINITY};
        result = setrlimit(RLIMIT_AS, &unlimited);
    } else {
        return false;
    }
    outcome = result >= 0 ? "worked" : std::strerror(errno);
    return true;
}

}  // namespace test_importer
