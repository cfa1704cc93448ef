// worker_channel.hpp -- messages between us and the worker process, over a sequenced-packet socket pair.
#pragma once
#include <cstdint>
#include <string>

namespace clarity::import {

// Descriptors that the worker finds open.
inline constexpr int kChannelFd = 3, kResultFd = 4;
// In the worker's environment: whoever sees it must not start workers of its own.
inline constexpr const char* kWorkerVariable = "CLARITY_IMPORT_WORKER";
// First message of a worker; a program that is none says something else, or nothing.
inline constexpr const char* kWorkerGreeting = "clarity import worker 1";

enum class MessageKind : uint32_t {
    greeting = 1,  // text: kWorkerGreeting
    running,       // text: file, line break, importer; the worker waits for `proceed`
    stage,         // text: as Progress::stage
    progress,      // fraction
    log,           // level, text
    death,         // text: what the worker knows about its own end, "stack overflow"
    failed,        // text: error message, naming the file
    done,          // the result is complete and sealed
    cancel,        // to the worker
    proceed,       // to the worker: its limits are right for the file that it named
};

struct Message {
    MessageKind kind{};
    int32_t level = 0;
    float fraction = 0;
    std::string text;  // longer ones arrive cut
};

// False if the other side is gone. Safe in a signal handler for texts of less than 256 bytes, through send_short.
bool send_message(int fd, const Message& message);
void send_short(int fd, MessageKind kind, const char* text);

enum class Received { message, nothing, closed };
// Does not wait. A malformed packet counts as `closed`.
Received receive_message(int fd, Message& message);

}  // namespace clarity::import
