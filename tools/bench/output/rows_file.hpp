// rows_file.hpp -- a JSON file of records which grows during the run, so that a run which crashes loses no row.
#pragma once
#include <cstdio>
#include <string>

#include "tools/bench/output/record.hpp"

namespace clarity::bench {

// add() appends each row at once to the file `path`.part. finish() writes the whole report to `path`, in which rows also hold
// the end of the run and the means over all scenes, and removes the other file. Without finish(), the destructor closes the
// list and moves it to `path`. After a kill, `path`.part holds all rows, and read_bench_json() can read it. Functions throw
// Error(failed) if a file cannot be written.
class RowsFile {
 public:
    explicit RowsFile(std::string path);
    ~RowsFile();
    RowsFile(const RowsFile&) = delete;
    RowsFile& operator=(const RowsFile&) = delete;

    // Appends the last record of `report`.
    void add(const BenchReport& report);
    void finish(const BenchReport& report);

 private:
    [[noreturn]] void fail(const char* what) const;
    void remove_part();

    const std::string path_, part_;
    std::FILE* file_ = nullptr;  // null if finished, or if `path` is a pipe or device, which cannot be replaced
    bool any_ = false;
    bool torn_ = false;  // the last row was written in part, for example because the disk is full
};

}  // namespace clarity::bench
