// thread_priority.hpp -- the window answers first: threads that compute step back where cores are scarce.
#pragma once
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace clarity::ui {

// Lowers the calling thread's share, and that of the threads it starts (drivers' and builders' pools among them): Linux keeps
// the nice value by thread. Costs nothing on an idle machine.
inline void yield_to_window() {
    setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), 5);
}

}  // namespace clarity::ui
