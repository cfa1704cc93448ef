// findings.hpp -- collects the faults of a structure in one line.
#pragma once
#include <cmath>
#include <sstream>
#include <string>

#include "harness.hpp"

namespace accel_test {

class Findings {
 protected:
    explicit Findings(const Built& built) : built_(built) {}

    // Returns the stream to which the caller writes the next fault.
    std::ostream& say() {
        if (!none()) why_ << "; ";
        return why_;
    }
    bool none() const { return why_.str().empty(); }
    std::string all() const { return why_.str(); }

    void expect(const char* label, double value) {
        const auto found = built_.stats.find(label);
        if (found == built_.stats.end() || std::fabs(found->second - value) > 1e-6 * std::fabs(value))
            say() << "stat " << label << " is not " << value;
    }

    const Built& built_;

 private:
    std::ostringstream why_;
};

}  // namespace accel_test
