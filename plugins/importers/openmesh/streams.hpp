// streams.hpp -- the streams that OpenMesh's readers read from: bytes in memory, or lines that are checked and corrected on the
// way.
//
// OpenMesh 9 trusts its files. It continues behind the end of the data (one crafted PLY keeps it busy for minutes). It drops a
// vertex that it cannot parse, so all later indices refer to wrong vertices. It knows comments in some places only.
#pragma once
#include <functional>
#include <streambuf>
#include <string>
#include <string_view>

namespace openmesh_import {

// Takes the progress, 0..1. Throws to cancel.
using ReportProgress = std::function<void(float)>;

// `front` followed by `bytes`, as one stream. Seekable. `bytes` must outlive the stream.
class BytesBuffer : public std::streambuf {
 public:
    BytesBuffer(std::string front, std::string_view bytes, ReportProgress progress);
    // The position of the next byte, relative to the start of `bytes`.
    size_t position() const;

 protected:
    int_type underflow() override;
    pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode which) override;
    pos_type seekpos(pos_type position, std::ios_base::openmode which) override;

 private:
    bool show(size_t position);  // makes the window around `position` the get area; false at the end
    size_t next() const;

    std::string front_;
    std::string_view bytes_;
    ReportProgress progress_;
    size_t window_first_ = 0;  // position of the first byte of the get area
};

// Passes a text on line by line. `edit` may change a line, or drop it by returning false. Rewinding the stream starts a new
// pass.
class LineBuffer : public std::streambuf {
 public:
    // `pass` counts from 0.
    using Edit = std::function<bool(std::string_view line, int pass, std::string& out)>;
    // join_continued: a backslash at the end of a line joins it with the next line. pass_count is for the progress only.
    LineBuffer(std::string_view text, bool join_continued, Edit edit, int pass_count, ReportProgress progress);
    // The number of the last line that was passed on, from 1.
    size_t line_number() const { return line_number_; }

 protected:
    int_type underflow() override;
    pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode which) override;
    pos_type seekpos(pos_type position, std::ios_base::openmode which) override;

 private:
    std::string_view text_, rest_;
    bool join_continued_;
    Edit edit_;
    int pass_ = 0, pass_count_;
    ReportProgress progress_;
    size_t line_number_ = 0, lines_since_report_ = 0;
    std::string joined_, out_;
};

}  // namespace openmesh_import
