// record_fields.hpp -- the table of a record's fields: key in JSON and CSV, member of the record, and how tables and the report
// show it. To add a statistic, add a member to BenchRecord (or Analysis, or Summary) and a line to its table here.
#pragma once
#include "tools/bench/output/fields.hpp"
#include "tools/bench/output/output.hpp"
#include "tools/bench/output/record.hpp"

namespace clarity::bench {

const Fields<BenchRecord>& record_fields();
const Fields<Summary>& summary_fields();
const Fields<Analysis>& analysis_fields();
const Fields<BenchRun>& run_fields();

// The field of that key. Throws Error(failed) if there is none.
const Field<BenchRecord>& record_field(const std::string& key);

// The value as tables show it: scaled; "" for NaN, infinity, and a 0 which means that there is none.
std::string shown_text(double stored, const Look& look);
template <class Owner>
std::string shown_text(const Field<Owner>& field, const Owner& owner) {
    return shown_text(field.number(owner), field.look);
}

// One record as JSON, which CSV is also made from.

// Every key is present; its value is null if there is nothing to say.
Json record_json(const BenchReport& report, const BenchRecord& record);

}  // namespace clarity::bench
