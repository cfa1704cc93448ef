// streams.hpp -- what OpenMesh's readers read from: bytes in memory, or lines that are looked at (and mended) on their way.
//
// OpenMesh 9 trusts its files: it goes on at the end of the data (one crafted PLY keeps it busy for minutes), leaves out a
// vertex that it cannot parse (all later indices then name the wrong one), and knows comments in some places only.
#pragma once
#include <functional>
#include <streambuf>
#include <string>
#include <string_view>

namespace openmesh_import {

// 0..1; throws to cancel.
using ReportProgress = std::function<void(float)>;

// `front`, then `bytes`, as one stream. Seekable.
class BytesBuffer : public std::streambuf {
 public:
    BytesBuffer(std::string front, std::string_view bytes, ReportProgress progress);
    // Position of the next byte, counted in `bytes`.
    size_t position() const;

 protected:
    int_type underflow() override;
    pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode which) override;
    pos_type seekpos(pos_type position, std::ios_base::openmode which) override;

 private:
    bool show(size_t position);  // makes the window around it the get area
    size_t next() const;

    std::string front_;
    std::string_view bytes_;
    ReportProgress progress_;
    size_t window_first_ = 0;  // of the get area
};

// Hands out a text line by line; `edit` may change a line or drop it (return false). Rewinding starts a new pass.
class LineBuffer : public std::streambuf {
 public:
    // pass counts from 0.
    using Edit = std::function<bool(std::string_view line, int pass, std::string& out)>;
    // join_continued: a backslash at the end of a line goes on in the next.
    LineBuffer(std::string_view text, bool join_continued, Edit edit, int pass_count, ReportProgress progress);
    // Number of the line handed out last, from 1.
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
