// library.hpp -- what all calls of the library share: its plugins, the program for workers, and how exceptions become codes.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <functional>
#include <string>

#include "api/clarity.h"
#include "base/error.hpp"
#include "plugin/registry.hpp"

namespace clarity::api {

// Runs a call. Exceptions become its code, and their text is kept for clarity_error_text() on this thread.
int32_t run_call(const std::function<void()>& call) noexcept;
// The same for a call that leaves plugins and drivers alone: a process may be forked after it.
int32_t run_light_call(const std::function<void()>& call) noexcept;
// Deletes what a handle holds. Not after a fork from a process that had used the library, nor after its end by another
// thread: nothing may be touched then.
void run_free(const std::function<void()>& free);
// Cancels the calls of other threads and waits for them.
void end_library();
bool has_ended();
// Whether this thread has ended the library, and may go on.
bool goes_on_after_end();

// The time in which a function of the caller runs on this thread. Calls of the library are refused in it: they would wait for
// the call that waits for this function.
class InCallersFunction {
 public:
    InCallersFunction();
    ~InCallersFunction();
    InCallersFunction(const InCallersFunction&) = delete;
    InCallersFunction& operator=(const InCallersFunction&) = delete;

 private:
    const bool outer_;
};
const std::string& error_text();
const std::string& error_details();

// The plugins, found in the first call that needs them. Throws Error if the program for workers is not found.
const PluginRegistry& plugins();
void set_program(const std::string& path);
void set_log(void (*log)(void*, int32_t, const char*), void* user);

// Bytes of a struct in the first release that has it. Fields that were appended later are 0 for callers that lack them.
template <class T>
constexpr size_t kFirstBytes = sizeof(T);
template <>
inline constexpr size_t kFirstBytes<clarity_rays> = offsetof(clarity_rays, mask);

// A copy of a struct of the caller, which may be shorter or longer than ours. name: for messages.
template <class T>
T copy_of(const T* given, const char* name) {
    if (!given) throw Error(Exit::usage, std::string("the pointer to ") + name + " is null");
    if (given->struct_bytes < kFirstBytes<T>)
        throw Error(Exit::usage, std::string(name) + "::struct_bytes is " + std::to_string(given->struct_bytes) +
                                     ", expected " + std::to_string(kFirstBytes<T>) + " or more: set it to sizeof(" + name +
                                     ")");
    T copy{};
    std::memcpy(&copy, given, std::min<size_t>(given->struct_bytes, sizeof(T)));
    return copy;
}

// name: of an argument.
template <class T>
T& not_null(T* pointer, const char* name) {
    if (!pointer) throw Error(Exit::usage, std::string("the pointer `") + name + "` is null");
    return *pointer;
}

inline std::string text_of(const char* text) {
    return text ? text : "";
}

}  // namespace clarity::api
