// seccomp.cpp -- allows the system calls that a file parser or a builder needs; all others fail with EPERM. Calls newer than
// this list fail with ENOSYS, after which the C library uses older ones instead. Workers that load OpenCL drivers may do
// everything but what no driver needs.
#include <fcntl.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "worker/sandbox.hpp"

namespace clarity::worker {
namespace {

// libseccomp skips the calls that this architecture does not have.
const int kAllowed[] = {
    // reading; open() itself is restricted below
    SCMP_SYS(read), SCMP_SYS(readv), SCMP_SYS(pread64), SCMP_SYS(preadv), SCMP_SYS(lseek), SCMP_SYS(close), SCMP_SYS(fstat),
    SCMP_SYS(newfstatat), SCMP_SYS(statx), SCMP_SYS(faccessat), SCMP_SYS(readlinkat), SCMP_SYS(getdents64), SCMP_SYS(getcwd),
    SCMP_SYS(dup), SCMP_SYS(fadvise64), SCMP_SYS(fcntl), SCMP_SYS(statfs), SCMP_SYS(fstatfs), SCMP_SYS(ppoll), SCMP_SYS(stat),
    SCMP_SYS(lstat), SCMP_SYS(access), SCMP_SYS(readlink), SCMP_SYS(getdents), SCMP_SYS(poll), SCMP_SYS(time),
    // writing the result and the messages: only files that are open already, since none can be opened for writing
    SCMP_SYS(write), SCMP_SYS(writev), SCMP_SYS(pwrite64),
    // memory (executable mappings are restricted below)
    SCMP_SYS(brk), SCMP_SYS(munmap), SCMP_SYS(mremap), SCMP_SYS(madvise), SCMP_SYS(msync), SCMP_SYS(mincore), SCMP_SYS(mlock),
    SCMP_SYS(munlock), SCMP_SYS(get_mempolicy), SCMP_SYS(membarrier),
    // threads and time
    SCMP_SYS(futex), SCMP_SYS(set_robust_list), SCMP_SYS(rseq), SCMP_SYS(set_tid_address), SCMP_SYS(sched_yield),
    SCMP_SYS(sched_getaffinity), SCMP_SYS(sched_getparam), SCMP_SYS(sched_getscheduler), SCMP_SYS(getcpu), SCMP_SYS(gettid),
    SCMP_SYS(getpid), SCMP_SYS(getppid), SCMP_SYS(nanosleep), SCMP_SYS(clock_nanosleep), SCMP_SYS(clock_gettime),
    SCMP_SYS(clock_getres), SCMP_SYS(gettimeofday), SCMP_SYS(times), SCMP_SYS(getrusage), SCMP_SYS(arch_prctl),
    // the process's own signals, and its end
    SCMP_SYS(rt_sigaction), SCMP_SYS(rt_sigprocmask), SCMP_SYS(rt_sigreturn), SCMP_SYS(rt_sigpending), SCMP_SYS(sigaltstack),
    SCMP_SYS(restart_syscall), SCMP_SYS(exit), SCMP_SYS(exit_group),
    // harmless; the undefined-behaviour sanitizer uses it to find out which memory is readable
    SCMP_SYS(pipe2), SCMP_SYS(pipe),
    // queries
    SCMP_SYS(uname), SCMP_SYS(sysinfo), SCMP_SYS(getrlimit), SCMP_SYS(getuid), SCMP_SYS(geteuid), SCMP_SYS(getgid),
    SCMP_SYS(getegid), SCMP_SYS(getrandom)};

// What a worker with a driver must not do: the network, other processes' memory, and the system as a whole.
const int kRefused[] = {
    SCMP_SYS(connect),      SCMP_SYS(bind),       SCMP_SYS(listen),  SCMP_SYS(accept),           SCMP_SYS(accept4),
    SCMP_SYS(ptrace),       SCMP_SYS(mount),      SCMP_SYS(umount2), SCMP_SYS(pivot_root),       SCMP_SYS(chroot),
    SCMP_SYS(reboot),       SCMP_SYS(swapon),     SCMP_SYS(swapoff), SCMP_SYS(init_module),      SCMP_SYS(finit_module),
    SCMP_SYS(bpf),          SCMP_SYS(setuid),     SCMP_SYS(setgid),  SCMP_SYS(process_vm_readv), SCMP_SYS(process_vm_writev),
    SCMP_SYS(settimeofday), SCMP_SYS(sethostname)};

// From this number on all architectures use the same numbers. All calls above are older, except statx, getrandom, membarrier
// and rseq. The last call today is about 470. Each number costs one rule: 600 of them took 7 ms at every import, these take 1
// ms.
constexpr int kFirstUnified = 424, kEndUnified = 512;

// Collects rules; remembers the first error.
class Filter {
 public:
    explicit Filter(uint32_t otherwise) : context_(seccomp_init(otherwise), seccomp_release) {
        if (!context_) {
            error_ = ENOMEM;
            return;
        }
        set(SCMP_FLTATR_ACT_BADARCH, SCMP_ACT_KILL_PROCESS);
        set(SCMP_FLTATR_CTL_TSYNC, 1);     // for all threads: a plugin's library may have started some when it was loaded
        set(SCMP_FLTATR_CTL_OPTIMIZE, 2);  // binary search instead of one comparison after the other
    }
    void add(uint32_t action, int call) {
        if (error_ == 0) error_ = -seccomp_rule_add_array(context_.get(), action, call, 0, nullptr);
    }
    void allow(int call) { add(SCMP_ACT_ALLOW, call); }
    void allow_if(int call, scmp_arg_cmp condition) {
        if (error_ == 0) error_ = -seccomp_rule_add_array(context_.get(), SCMP_ACT_ALLOW, call, 1, &condition);
    }
    // Allows the call if (argument & mask) == value.
    void allow_if(int call, unsigned argument, uint32_t mask, uint32_t value) {
        allow_if(call, scmp_arg_cmp{argument, SCMP_CMP_MASKED_EQ, mask, value});
    }
    // Installs the filter. Returns 0 or an errno.
    int load() {
        if (error_ == 0) error_ = -seccomp_load(context_.get());
        return error_;
    }

 private:
    void set(scmp_filter_attr attribute, uint32_t value) {
        if (error_ == 0) error_ = -seccomp_attr_set(context_.get(), attribute, value);
    }
    const std::unique_ptr<void, void (*)(scmp_filter_ctx)> context_;
    int error_ = 0;
};

}  // namespace

Problem detail::restrict_system_calls(WorkerKind kind) {
    const auto note = [](int error) {
        return error == 0 ? std::string() : std::string("seccomp is not available: ") + std::strerror(error);
    };
    if (kind == WorkerKind::driver) {
        if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return "no_new_privs is not available";
        Filter filter(SCMP_ACT_ALLOW);
        for (const int call : kRefused) filter.add(SCMP_ACT_ERRNO(EPERM), call);
        return note(filter.load());
    }
    constexpr uint32_t kAll = 0xFFFFFFFFu;
    constexpr uint32_t kWriting = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC;
    const auto self = static_cast<uint32_t>(getpid());
    Filter filter(SCMP_ACT_ERRNO(EPERM));
    for (const int call : kAllowed) filter.allow(call);
    filter.allow_if(SCMP_SYS(openat), 2, kWriting, 0);
    filter.allow_if(SCMP_SYS(open), 1, kWriting, 0);
    if (kind == WorkerKind::loader) {
        for (const int call : {SCMP_SYS(mmap), SCMP_SYS(mprotect), SCMP_SYS(seccomp)}) filter.allow(call);
        filter.allow_if(SCMP_SYS(prctl), 0, kAll, PR_SET_NO_NEW_PRIVS);
    } else {
        filter.allow_if(SCMP_SYS(mmap), 2, PROT_EXEC, 0);
        filter.allow_if(SCMP_SYS(mprotect), 2, PROT_EXEC, 0);
    }
    filter.allow_if(SCMP_SYS(clone), 0, CLONE_THREAD, CLONE_THREAD);
    filter.allow_if(SCMP_SYS(kill), 0, kAll, self);
    filter.allow_if(SCMP_SYS(tgkill), 0, kAll, self);
    for (const uint32_t request : {uint32_t(TCGETS), uint32_t(FIONREAD)}) filter.allow_if(SCMP_SYS(ioctl), 1, kAll, request);
    constexpr uint32_t kNameMemory = 0x53564D41;  // PR_SET_VMA: newer C libraries name their memory with it
    for (const uint32_t option : {uint32_t(PR_SET_NAME), uint32_t(PR_GET_NAME), kNameMemory})
        filter.allow_if(SCMP_SYS(prctl), 0, kAll, option);
    // Limits may be read but not set. Exception: the limit on file sizes, so that the result can be written; its hard limit
    // still holds.
    filter.allow_if(SCMP_SYS(prlimit64), scmp_arg_cmp{2, SCMP_CMP_EQ, 0, 0});
    filter.allow_if(SCMP_SYS(setrlimit), 0, kAll, RLIMIT_FSIZE);
    for (int call = kFirstUnified; call < kEndUnified; ++call) filter.add(SCMP_ACT_ERRNO(ENOSYS), call);
    return note(filter.load());
}

}  // namespace clarity::worker
