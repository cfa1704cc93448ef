#include "streams.hpp"

#include <algorithm>

#include "text.hpp"

namespace openmesh_import {
namespace {

constexpr size_t kWindowBytes = 1 << 20;  // bytes between two progress reports
constexpr size_t kWindowLines = 1 << 14;

}  // namespace

BytesBuffer::BytesBuffer(std::string front, std::string_view bytes, ReportProgress progress)
    : front_(std::move(front)), bytes_(bytes), progress_(std::move(progress)) {
    show(0);
}

size_t BytesBuffer::next() const {
    return window_first_ + static_cast<size_t>(gptr() - eback());
}

size_t BytesBuffer::position() const {
    return next() > front_.size() ? next() - front_.size() : 0;
}

bool BytesBuffer::show(size_t position) {
    const bool in_front = position < front_.size();
    const size_t base = in_front ? 0 : front_.size();
    const std::string_view part = in_front ? std::string_view(front_) : bytes_;
    const size_t at = std::min(position - base, part.size());
    const size_t first = at / kWindowBytes * kWindowBytes, count = std::min(kWindowBytes, part.size() - first);
    char* start = const_cast<char*>(part.data()) + first;  // the get area is never written to
    setg(start, start + (at - first), start + count);
    window_first_ = base + first;
    return at - first < count;
}

BytesBuffer::int_type BytesBuffer::underflow() {
    if (gptr() == egptr() && !show(next())) return traits_type::eof();
    if (progress_ && !bytes_.empty()) progress_(static_cast<float>(position()) / static_cast<float>(bytes_.size()));
    return traits_type::to_int_type(*gptr());
}

BytesBuffer::pos_type BytesBuffer::seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode which) {
    const off_type total = static_cast<off_type>(front_.size() + bytes_.size());
    const off_type base = from == std::ios_base::beg ? 0 : from == std::ios_base::cur ? static_cast<off_type>(next()) : total;
    return seekpos(base + offset, which);
}

BytesBuffer::pos_type BytesBuffer::seekpos(pos_type position, std::ios_base::openmode) {
    const off_type at = position;
    if (at < 0 || at > static_cast<off_type>(front_.size() + bytes_.size())) return pos_type(off_type(-1));
    show(static_cast<size_t>(at));
    return position;
}

LineBuffer::LineBuffer(std::string_view text, bool join_continued, Edit edit, int pass_count, ReportProgress progress)
    : text_(text),
      rest_(text),
      join_continued_(join_continued),
      edit_(std::move(edit)),
      pass_count_(pass_count),
      progress_(std::move(progress)) {}

LineBuffer::int_type LineBuffer::underflow() {
    while (gptr() == egptr()) {
        if (rest_.empty()) return traits_type::eof();
        std::string_view line = next_line(rest_);
        ++line_number_;
        if (join_continued_ && !line.empty() && line.back() == '\\') {
            joined_.assign(line.substr(0, line.size() - 1));
            while (!rest_.empty()) {
                line = next_line(rest_);
                ++line_number_;
                const bool goes_on = !line.empty() && line.back() == '\\';
                joined_.append(" ").append(goes_on ? line.substr(0, line.size() - 1) : line);
                if (!goes_on) break;
            }
            line = joined_;
        }
        out_.clear();
        if (edit_(line, pass_, out_)) {
            out_ += '\n';
            setg(out_.data(), out_.data(), out_.data() + out_.size());
        }
        if (++lines_since_report_ == kWindowLines) {
            lines_since_report_ = 0;
            const float done = 1 - static_cast<float>(rest_.size()) / static_cast<float>(text_.size());
            if (progress_)
                progress_((static_cast<float>(std::min(pass_, pass_count_ - 1)) + done) / static_cast<float>(pass_count_));
        }
    }
    return traits_type::to_int_type(*gptr());
}

LineBuffer::pos_type LineBuffer::seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode which) {
    return from == std::ios_base::beg ? seekpos(offset, which) : pos_type(off_type(-1));
}

LineBuffer::pos_type LineBuffer::seekpos(pos_type position, std::ios_base::openmode) {
    if (position != pos_type(0)) return pos_type(off_type(-1));
    rest_ = text_;
    line_number_ = 0;
    ++pass_;
    setg(nullptr, nullptr, nullptr);
    return 0;
}

}  // namespace openmesh_import
