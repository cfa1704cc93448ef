// rows_file.hpp -- a JSON file of records which grows during the run, so that a run which crashes loses no row.
#pragma once
#include <memory>
#include <string>

#include "base/output_file.hpp"
#include "bench/output/record.hpp"

namespace clarity::bench {

// add() appends each row at once to a temporary file beside `path`. finish() then replaces it with the whole report, in which
// rows also hold the end of the run and the means over all scenes. Without finish(), the destructor closes the list and moves
// the file to `path`. After a kill, the temporary file holds all rows, and read_bench_json() can read it. Functions throw
// Error(failed) if the file cannot be written.
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
    const std::string path_;
    std::unique_ptr<OutputFile> file_;  // null if finished, or if `path` is a pipe or device, which cannot be replaced
    bool any_ = false;
    bool torn_ = false;  // the last row was written in part, for example because the disk is full
};

}  // namespace clarity::bench
