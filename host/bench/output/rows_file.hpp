// rows_file.hpp -- a JSON file of records that grows while they are measured, so that a run that dies loses none.
#pragma once
#include <memory>
#include <string>

#include "base/output_file.hpp"
#include "bench/output/record.hpp"

namespace clarity::bench {

// Rows go into the temporary file beside `path` at once. finish() writes the whole report instead, whose rows also know how the
// run ended and what the means over all of its scenes are. Without finish(), the destructor closes the list and puts the rows
// in place. After a kill, the temporary file holds all rows, and read_bench_json() reads it.
// Functions throw Error(failed) where the file cannot be written.
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
    std::unique_ptr<OutputFile> file_;  // null: a pipe or device, which cannot be replaced, or done
    bool any_ = false;
    bool torn_ = false;  // the last row is there in part: the disk is full, say
};

}  // namespace clarity::bench
