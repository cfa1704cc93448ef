// A message is a MessageHead followed by the text. It is sent with plain read and write, because the worker's sandbox forbids
// socket calls.
#include "worker/channel.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <iterator>

namespace clarity::worker {
namespace {

constexpr size_t kMaxText = 8000;
struct MessageHead {
    uint32_t kind;
    int32_t level;
    float fraction;
    uint32_t text_bytes;
};
using MessageBytes = std::array<char, sizeof(MessageHead) + kMaxText>;

bool write_message(int fd, const char* buffer, size_t bytes) {
    for (;;) {
        const ssize_t written = write(fd, buffer, bytes);
        if (written >= 0) return true;
        if (errno != EINTR) return false;
    }
}

}  // namespace

bool in_worker() {
    return std::any_of(std::begin(kWorkerVariables), std::end(kWorkerVariables),
                       [](const char* name) { return std::getenv(name); });
}

std::string greeting_of(const char* kind) {
    return std::string("clarity ") + kind + " worker 2";
}

bool send_message(int fd, const Message& message) {
    const size_t text_bytes = std::min(message.text.size(), kMaxText);
    const MessageHead head = {static_cast<uint32_t>(message.kind), message.level, message.fraction,
                              static_cast<uint32_t>(text_bytes)};
    MessageBytes buffer;
    std::memcpy(buffer.data(), &head, sizeof head);
    std::memcpy(buffer.data() + sizeof head, message.text.data(), text_bytes);
    return write_message(fd, buffer.data(), sizeof head + text_bytes);
}

void send_short(int fd, MessageKind kind, const char* text) {
    const int saved_errno = errno;
    char buffer[sizeof(MessageHead) + 256];
    const size_t text_bytes = std::min<size_t>(std::strlen(text), 256);
    const MessageHead head = {static_cast<uint32_t>(kind), 0, 0, static_cast<uint32_t>(text_bytes)};
    std::memcpy(buffer, &head, sizeof head);
    std::memcpy(buffer + sizeof head, text, text_bytes);
    write_message(fd, buffer, sizeof head + text_bytes);
    errno = saved_errno;
}

Received receive_message(int fd, Message& message) {
    MessageBytes buffer;
    ssize_t bytes = -1;
    do {
        pollfd ready = {fd, POLLIN, 0};
        const int count = poll(&ready, 1, 0);
        if (count == 0 || (count < 0 && errno == EINTR)) return Received::nothing;
        if (count < 0) return Received::closed;
        bytes = read(fd, buffer.data(), buffer.size());
    } while (bytes < 0 && errno == EINTR);
    MessageHead head;
    if (bytes < static_cast<ssize_t>(sizeof head)) return Received::closed;
    std::memcpy(&head, buffer.data(), sizeof head);
    if (head.text_bytes != static_cast<size_t>(bytes) - sizeof head) return Received::closed;
    message.kind = static_cast<MessageKind>(head.kind);
    message.level = head.level;
    message.fraction = head.fraction;
    message.text.assign(buffer.data() + sizeof head, head.text_bytes);
    return Received::message;
}

}  // namespace clarity::worker
