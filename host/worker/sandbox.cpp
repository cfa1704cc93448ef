#include "worker/sandbox.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "base/log.hpp"

#if __has_include(<linux/landlock.h>)
#include <linux/landlock.h>
#define CLARITY_LANDLOCK
#endif

namespace clarity::worker {
namespace {

// Sanitizers reserve terabytes of address space. In such builds only the parent's check of resident memory limits the worker.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimitAddressSpace = false;
#else
constexpr bool kLimitAddressSpace = true;
#endif

uint64_t mapped_bytes() {
    unsigned long long pages = 0;
    std::FILE* file = std::fopen("/proc/self/statm", "re");
    if (!file) return 0;
    const bool read = std::fscanf(file, "%llu", &pages) == 1;
    std::fclose(file);
    return read ? pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE)) : 0;
}

void note(const std::string& text) {
    log(LogLevel::debug, "worker: " + text);
}

void limit(int resource, uint64_t soft, uint64_t hard, const char* what) {
    rlimit now{};
    getrlimit(static_cast<__rlimit_resource>(resource), &now);
    const rlimit wanted = {std::min<rlim_t>(soft, now.rlim_max), std::min<rlim_t>(hard, now.rlim_max)};
    if (setrlimit(static_cast<__rlimit_resource>(resource), &wanted) != 0)
        note(std::string(what) + " is not limited: " + std::strerror(errno));
}

}  // namespace

void enter_sandbox(WorkerKind kind, const std::vector<std::string>& folders, const std::vector<std::string>& files,
                   const WorkerLimits& limits) {
    // Small thread stacks and few malloc arenas: on a machine with many cores they would otherwise use up the address space,
    // which a driver may have. Kernels are tried there on 7/8 of the stack that a thread has in the program, so that one that
    // passes has room in the program too, where it is compiled without checks. A frame too large for its stack would lie in
    // that of the next thread: so a gap is between them that no frame spans.
    constexpr size_t kSmall = size_t{2} << 20, kGap = size_t{1} << 30;
    pthread_attr_t attributes;
    pthread_getattr_default_np(&attributes);
    size_t stack_bytes = 0;
    pthread_attr_getstacksize(&attributes, &stack_bytes);
    const bool driver = kind == WorkerKind::driver && kLimitAddressSpace;
    pthread_attr_setstacksize(&attributes, driver ? stack_bytes / 8 * 7 : kSmall);
    if (driver) pthread_attr_setguardsize(&attributes, kGap);
    pthread_setattr_default_np(&attributes);
    pthread_attr_destroy(&attributes);
    mallopt(M_ARENA_MAX, 2);

    limit(RLIMIT_STACK, limits.stack_bytes, limits.stack_bytes, "the stack");
    limit(RLIMIT_CORE, 0, 0, "the core file");
    // At the soft limit the process gets SIGXCPU, which tells the parent the reason; SIGKILL follows one second later.
    if (limits.cpu_s > 0) limit(RLIMIT_CPU, limits.cpu_s, limits.cpu_s + 1, "processor time");
    signal(SIGXFSZ, SIG_IGN);
    if (kind == WorkerKind::driver) {
        if (const Problem why = detail::restrict_system_calls(kind)) note("system calls are not restricted: " + why.text());
        return;
    }
    limit(RLIMIT_NOFILE, 64, 64, "the number of open files");
    const uint64_t most = std::max(limits.memory_bytes, limits.most_memory_bytes);
    limit(RLIMIT_FSIZE, 0, most > 0 ? most : RLIM_INFINITY, "writing");
    if (limits.memory_bytes > 0) {
        if (kLimitAddressSpace) {
            const uint64_t mapped = mapped_bytes();
            limit(RLIMIT_AS, mapped + limits.memory_bytes, mapped + most, "memory");
        } else {
            note("address space is not limited in a build with a sanitizer");
        }
    }
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) note("no_new_privs is not available");
    if (const Problem why = detail::restrict_files(folders, files))
        note("reading is not restricted to the scene's folders: " + why.text());
    if (const Problem why = detail::restrict_system_calls(kind)) note("system calls are not restricted: " + why.text());
}

void allow_writing_result() {
    rlimit now{};
    getrlimit(RLIMIT_FSIZE, &now);
    now.rlim_cur = now.rlim_max;
    // A direct system call: the C library may use prlimit64, and the sandbox forbids setting limits with it.
    syscall(SYS_setrlimit, RLIMIT_FSIZE, &now);
}

void enter_tool_sandbox(const std::vector<std::string>& folders, const std::string& work, const WorkerLimits& limits,
                        uint64_t file_bytes) {
    enter_sandbox(WorkerKind::driver, {}, {}, limits);
    if (kLimitAddressSpace) limit(RLIMIT_AS, limits.memory_bytes, limits.memory_bytes, "memory");
    limit(RLIMIT_FSIZE, file_bytes, file_bytes, "writing");
    if (const Problem why = detail::restrict_files(folders, {}, work)) note("files are not restricted: " + why.text());
}

bool restricts_files() {
#ifdef CLARITY_LANDLOCK
    return syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION) >= 1;
#else
    return false;
#endif
}

#ifdef CLARITY_LANDLOCK
Problem detail::restrict_files(const std::vector<std::string>& folders, const std::vector<std::string>& files,
                               const std::string& work) {
    const long version = syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
    if (version < 1) return std::string("Landlock is not available: ") + std::strerror(errno);
    landlock_ruleset_attr ruleset{};
    // All thirteen rights of Landlock's first version, one bit each. Later versions add one each: 2 moving and linking between
    // folders, 3 truncation.
    ruleset.handled_access_fs = (1u << 13) - 1;
    if (version >= 2) ruleset.handled_access_fs |= 1u << 13;
    if (version >= 3) ruleset.handled_access_fs |= 1u << 14;
    const int fd = static_cast<int>(syscall(SYS_landlock_create_ruleset, &ruleset, sizeof ruleset, 0));
    if (fd < 0) return std::string("Landlock: ") + std::strerror(errno);
    constexpr uint64_t kRightsOfFiles =
        LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_EXECUTE;
    const auto allow = [&](const std::string& path, uint64_t rights) {
        landlock_path_beneath_attr rule{};
        rule.allowed_access = rights;
        rule.parent_fd = open(path.c_str(), O_PATH | O_CLOEXEC);
        if (rule.parent_fd < 0) return;  // then the path is not readable, which is safe
        // The kernel refuses a file's rule with rights of folders.
        struct stat status{};
        if (fstat(rule.parent_fd, &status) == 0 && !S_ISDIR(status.st_mode)) rule.allowed_access &= kRightsOfFiles;
        syscall(SYS_landlock_add_rule, fd, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
        close(rule.parent_fd);
    };
    const uint64_t reads = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
    for (const std::string& folder : folders) allow(folder, work.empty() ? reads : reads | LANDLOCK_ACCESS_FS_EXECUTE);
    for (const std::string& file : files) allow(file, LANDLOCK_ACCESS_FS_READ_FILE);
    if (!work.empty()) {
        allow(work, ruleset.handled_access_fs);
        allow("/dev/null", LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_WRITE_FILE);
    }
    const bool entered = syscall(SYS_landlock_restrict_self, fd, 0) == 0;
    const std::string why = entered ? "" : std::string("Landlock: ") + std::strerror(errno);
    close(fd);
    return why;
}
#else
Problem detail::restrict_files(const std::vector<std::string>&, const std::vector<std::string>&, const std::string&) {
    return "built without Landlock's header";
}
#endif

}  // namespace clarity::worker
