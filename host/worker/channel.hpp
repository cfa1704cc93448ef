// channel.hpp -- messages between the worker process and its parent, through a sequenced-packet socket pair.
#pragma once
#include <cstdint>
#include <string>

namespace clarity::worker {

// File descriptors which are open when the worker starts.
inline constexpr int kChannelFd = 3, kResultFd = 4, kArgumentsFd = 5;
// Set in the worker's environment. A process that has one of them must not start workers of its own. The second is an older
// name of the first.
inline constexpr const char* kWorkerVariables[] = {"CLARITY_IN_WORKER", "CLARITY_IMPORT_WORKER"};
bool in_worker();
// A worker's command is its kind and this end: "import-worker".
inline constexpr const char* kCommandEnd = "-worker";
std::string greeting_of(const char* kind);  // the first message of our workers

enum class MessageKind : uint32_t {
    greeting = 1,  // text: greeting_of(). Any other program says something else, or nothing
    running,       // text: the step that begins; fraction: seconds that it may take, or 0: as long as the one before
    stage,         // text as for Progress::stage
    progress,      // fraction
    log,           // level, text
    death,         // text: the cause of death as the worker sees it, "stack overflow"
    no_memory,     // memory was refused; if the worker dies, this was the reason
    failed,        // level: Failure; text: error message, naming the file or the plugin
    cancelled,     // the work stopped because it was told to
    report,        // text: a part of the result
    done,          // the result is complete and sealed
    cancel,        // to the worker: stop
    proceed,       // to the worker: its limits now allow for the step that it named, if it waits for that
};

struct Message {
    MessageKind kind{};
    int32_t level = 0;
    float fraction = 0;
    std::string text;  // longer texts arrive truncated
};

// Sends one message; returns false if the other side is gone. send_short() is safe in a signal handler, for texts of less than
// 256 bytes.
bool send_message(int fd, const Message& message);
void send_short(int fd, MessageKind kind, const char* text);

enum class Received { message, nothing, closed };
// Receives a message without waiting. A malformed one counts as `closed`.
Received receive_message(int fd, Message& message);

}  // namespace clarity::worker
