// thread_priority.hpp -- lowers the priority of computing threads, so that the window stays responsive when cores are scarce.
#pragma once
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace clarity::ui {

// Lowers the priority of the calling thread and of the threads that it starts later (pools of drivers and builders among them).
// Linux keeps the nice value per thread. On an idle machine this costs nothing.
inline void yield_to_window() {
    setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), 5);
}

}  // namespace clarity::ui
