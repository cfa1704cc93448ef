// seccomp.cpp -- the system calls that a file parser needs, as a classic BPF program; all others fail with EPERM. Calls newer
// than this list fail with ENOSYS, after which the C library falls back on older ones.
#include <cerrno>
#include <cstddef>
#include <cstring>

#include "import/sandbox.hpp"

#if __has_include(<linux/seccomp.h>) && (defined(__x86_64__) || defined(__aarch64__))
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <termios.h>
#include <unistd.h>

namespace clarity {
namespace {

#if defined(__x86_64__)
constexpr uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#else
constexpr uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#endif

const int kAllowed[] = {
    // reading files that are open; the rest of open() is below
    SYS_read, SYS_readv, SYS_pread64, SYS_preadv, SYS_lseek, SYS_close, SYS_fstat, SYS_newfstatat, SYS_statx, SYS_faccessat,
    SYS_readlinkat, SYS_getdents64, SYS_getcwd, SYS_dup, SYS_fadvise64, SYS_fcntl, SYS_statfs, SYS_fstatfs, SYS_ppoll,
#if defined(__x86_64__)
    SYS_stat, SYS_lstat, SYS_access, SYS_readlink, SYS_getdents, SYS_poll, SYS_time,
#endif
    // the result and the messages: only what is open may be written to, and nothing can be opened for it
    SYS_write, SYS_writev,
    // memory (executable mappings are below)
    SYS_brk, SYS_munmap, SYS_mremap, SYS_madvise, SYS_msync, SYS_mincore, SYS_mlock, SYS_munlock, SYS_get_mempolicy,
    SYS_membarrier,
    // threads and time
    SYS_futex, SYS_set_robust_list, SYS_rseq, SYS_set_tid_address, SYS_sched_yield, SYS_sched_getaffinity, SYS_sched_getparam,
    SYS_sched_getscheduler, SYS_getcpu, SYS_gettid, SYS_getpid, SYS_getppid, SYS_nanosleep, SYS_clock_nanosleep,
    SYS_clock_gettime, SYS_clock_getres, SYS_gettimeofday, SYS_times, SYS_getrusage,
#if defined(__x86_64__)
    SYS_arch_prctl,
#endif
    // signals to oneself, and the end
    SYS_rt_sigaction, SYS_rt_sigprocmask, SYS_rt_sigreturn, SYS_rt_sigpending, SYS_sigaltstack, SYS_restart_syscall, SYS_exit,
    SYS_exit_group,
    // harmless, and the way in which the undefined-behaviour sanitizer finds out what memory may be read
    SYS_pipe2,
#if defined(__x86_64__)
    SYS_pipe,
#endif
    // questions
    SYS_uname, SYS_sysinfo, SYS_getrlimit, SYS_getuid, SYS_geteuid, SYS_getgid, SYS_getegid, SYS_getrandom};

constexpr uint32_t kDeny = SECCOMP_RET_ERRNO | EPERM;
constexpr uint32_t kUnknown = SECCOMP_RET_ERRNO | ENOSYS;
// From here on all architectures number alike; nothing above is newer but statx, getrandom, membarrier and rseq.
constexpr int kFirstUnified = 424;

// Builds `if (nr == call) { conditions on arguments -> allow; deny }` blocks.
class Filter {
 public:
    void add(uint16_t code, uint32_t k, uint8_t if_true = 0, uint8_t if_false = 0) {
        program_.push_back({code, if_true, if_false, k});
    }
    void load(size_t offset) { add(BPF_LD | BPF_W | BPF_ABS, static_cast<uint32_t>(offset)); }
    void result(uint32_t value) { add(BPF_RET | BPF_K, value); }
    void allow(int call) {
        add(BPF_JMP | BPF_JEQ | BPF_K, static_cast<uint32_t>(call), 0, 1);
        result(SECCOMP_RET_ALLOW);
    }
    // Allowed if (low word of the argument & mask) == value.
    void allow_if(int call, int argument, uint32_t mask, uint32_t value) {
        add(BPF_JMP | BPF_JEQ | BPF_K, static_cast<uint32_t>(call), 0, 5);
        load(offsetof(seccomp_data, args) + 8 * static_cast<size_t>(argument));  // little-endian: the low word comes first
        add(BPF_ALU | BPF_AND | BPF_K, mask);
        add(BPF_JMP | BPF_JEQ | BPF_K, value, 0, 1);
        result(SECCOMP_RET_ALLOW);
        load(offsetof(seccomp_data, nr));
    }
    // Allowed if a pointer is null, both words of it.
    void allow_if_null(int call, int argument) {
        const size_t offset = offsetof(seccomp_data, args) + 8 * static_cast<size_t>(argument);
        add(BPF_JMP | BPF_JEQ | BPF_K, static_cast<uint32_t>(call), 0, 6);
        load(offset);
        add(BPF_JMP | BPF_JEQ | BPF_K, 0, 0, 3);
        load(offset + 4);
        add(BPF_JMP | BPF_JEQ | BPF_K, 0, 0, 1);
        result(SECCOMP_RET_ALLOW);
        load(offsetof(seccomp_data, nr));
    }
    sock_fprog program() { return {static_cast<unsigned short>(program_.size()), program_.data()}; }

 private:
    std::vector<sock_filter> program_;
};

}  // namespace

std::string detail::restrict_system_calls() {
    constexpr uint32_t kAll = 0xFFFFFFFFu;
    constexpr uint32_t kWriting = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC;
    const uint32_t self = static_cast<uint32_t>(getpid());
    Filter filter;
    filter.load(offsetof(seccomp_data, arch));
    filter.add(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0);
    filter.result(SECCOMP_RET_KILL_PROCESS);
    filter.load(offsetof(seccomp_data, nr));
    for (const int call : kAllowed) filter.allow(call);
    filter.allow_if(SYS_openat, 2, kWriting, 0);
#if defined(__x86_64__)
    filter.allow_if(SYS_open, 1, kWriting, 0);
#endif
    filter.allow_if(SYS_mmap, 2, PROT_EXEC, 0);
    filter.allow_if(SYS_mprotect, 2, PROT_EXEC, 0);
    filter.allow_if(SYS_clone, 0, CLONE_THREAD, CLONE_THREAD);
    filter.allow_if(SYS_kill, 0, kAll, self);
    filter.allow_if(SYS_tgkill, 0, kAll, self);
    for (const uint32_t request : {uint32_t(TCGETS), uint32_t(FIONREAD)}) filter.allow_if(SYS_ioctl, 1, kAll, request);
    constexpr uint32_t kNameMemory = 0x53564D41;  // PR_SET_VMA, by which newer C libraries label their memory
    for (const uint32_t option : {uint32_t(PR_SET_NAME), uint32_t(PR_GET_NAME), kNameMemory}) {
        filter.allow_if(SYS_prctl, 0, kAll, option);
    }
    // To ask for limits, not to set them; but the result must become writable, below a hard limit.
    filter.allow_if_null(SYS_prlimit64, 2);
    filter.allow_if(SYS_setrlimit, 0, kAll, RLIMIT_FSIZE);
    filter.add(BPF_JMP | BPF_JGE | BPF_K, kFirstUnified, 0, 1);
    filter.result(kUnknown);
    filter.result(kDeny);
    const sock_fprog program = filter.program();
    // Of all threads: a plugin's library may have started some when it was loaded.
    if (syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &program) != 0) {
        return std::string("seccomp is not available: ") + std::strerror(errno);
    }
    return {};
}

}  // namespace clarity

#else
namespace clarity {
std::string detail::restrict_system_calls() {
    return "not written for this architecture";
}
}  // namespace clarity
#endif
