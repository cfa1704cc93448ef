// clarity compare: how much a picture differs from a reference.
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/pictures/picture_read.hpp"
#include "cli/commands.hpp"
#include "tools/compare/picture_errors.hpp"

namespace clarity {

int run_compare(const CompareCommand& command) {
    if (!command.output.empty()) {
        check_output_path(command.output);
        if (!writes_display(command.output))
            throw Error(Exit::usage, "-o " + command.output + ": the picture of errors is a .png");
    }
    const FloatImage test = read_picture(command.test), reference = read_picture(command.reference);
    const PictureErrors errors = picture_errors(test, reference);
    if (errors.not_finite > 0)
        log(LogLevel::warning, std::to_string(errors.not_finite) + (errors.not_finite == 1 ? " pixel holds" : " pixels hold") +
                                   " infinity or NaN and count in no figure");
    double full = 0;
    if (!command.output.empty()) write_image(command.output, {}, signed_error_picture(test, reference, full), picture_notes());

    const std::pair<const char*, double> figures[] = {{"rmse", errors.rmse},
                                                      {"trimmed_rmse", errors.trimmed_rmse},
                                                      {"relmse", errors.relmse},
                                                      {"flip", errors.flip},
                                                      {"mean", errors.mean},
                                                      {"reference_mean", errors.reference_mean},
                                                      {"mean_ratio", errors.mean_ratio},
                                                      {"largest", errors.largest}};
    if (command.json) {
        nlohmann::ordered_json json = {{"width", test.width}, {"height", test.height}, {"not_finite", errors.not_finite}};
        for (const auto& [key, value] : figures) json[key] = std::isfinite(value) ? nlohmann::ordered_json(value) : nullptr;
        json["largest_at"] = {errors.largest_x, errors.largest_y};
        if (full > 0) json["full_color"] = full;
        std::printf("%s\n", json.dump(1).c_str());
        return 0;
    }
    std::printf("%-15s %ux%u\n", "size", test.width, test.height);
    for (const auto& [key, value] : figures) std::printf("%-15s %.6g\n", key, value);
    std::printf("%-15s %u,%u\n", "largest at", errors.largest_x, errors.largest_y);
    if (full > 0) std::printf("%-15s %.6g\n", "full color", full);
    return 0;
}

}  // namespace clarity
