// record_fields.hpp -- all fields of a record, each one row: its key in JSON and CSV, where the record holds it, and how tables
// and the report show it. A new statistic is a member of BenchRecord (or Analysis, or Summary) and a row here.
#pragma once
#include "bench/output/fields.hpp"
#include "bench/output/record.hpp"

namespace clarity::bench {

const Fields<BenchRecord>& record_fields();
const Fields<Summary>& summary_fields();
const Fields<Analysis>& analysis_fields();
const Fields<BenchRun>& run_fields();

// The row of record_fields() with that key, which must exist.
const Field<BenchRecord>& record_field(const std::string& key);

// As tables show it: scaled, "" for 0 and for what is no number.
std::string shown_text(double stored, const Look& look);
template <class Owner>
std::string shown_text(const Field<Owner>& field, const Owner& owner) {
    return shown_text(field.number(owner), field.look);
}

}  // namespace clarity::bench
