// channel.hpp -- messages between the worker process and its parent, through a sequenced-packet socket pair.
#pragma once
#include <cstdint>
#include <string>

namespace clarity::worker {

// File descriptors which are open when the worker starts.
inline constexpr int kChannelFd = 3, kResultFd = 4;
// Set in the worker's environment. A process that has it must not start workers of its own.
inline constexpr const char* kWorkerVariable = "CLARITY_IMPORT_WORKER";

enum class MessageKind : uint32_t {
    greeting = 1,  // text: the kind of the worker, see child.hpp. Any other program says something else, or nothing
    running,       // text: what it runs now; importers: file, line break, importer, and the worker waits for `proceed`
    stage,         // text as for Progress::stage
    progress,      // fraction
    log,           // level, text
    death,         // text: the cause of death as the worker sees it, "stack overflow"
    failed,        // text: error message, naming the file or the plugin
    cancelled,     // the work stopped because it was told to
    report,        // text: one result of a check, as JSON
    done,          // the result is complete and sealed
    cancel,        // to the worker: stop
    proceed,       // to the worker: its limits now allow for the file that it named
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
// Receives a message without waiting. A malformed packet counts as `closed`.
Received receive_message(int fd, Message& message);

}  // namespace clarity::worker
